// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <stdexcept>

#include "core/kept_content.h"

namespace cdiff::core {
namespace {

class KeptContent : public testing::Test {
 protected:
  ~KeptContent() override { keepContent(0); }
  /// A value of a content; counts how often it is made.
  int value(const std::string& content) {
    return *keptContent<int>("number", content, [&] { return std::make_shared<int>(++made_); });
  }
  int made_ = 0;
};

TEST_F(KeptContent, MakesEachValueAnewUnlessItIsToKeepThem) {
  EXPECT_EQ(value("a"), 1);
  EXPECT_EQ(value("a"), 2);
  keepContent(2);
  EXPECT_EQ(value("a"), 3);
  EXPECT_EQ(value("a"), 3);
  EXPECT_EQ(value("b"), 4);
  keepContent(0);
  EXPECT_EQ(value("a"), 5);
}

TEST_F(KeptContent, DropsWhatWasNotAskedForLongest) {
  keepContent(2);
  EXPECT_EQ(value("a"), 1);
  EXPECT_EQ(value("b"), 2);
  EXPECT_EQ(value("a"), 1);
  EXPECT_EQ(value("c"), 3);
  EXPECT_EQ(value("a"), 1);
  EXPECT_EQ(value("b"), 4);
}

TEST_F(KeptContent, TellsKindsApart) {
  keepContent(2);
  EXPECT_EQ(value("a"), 1);
  EXPECT_EQ(
      *keptContent<std::string>("text", "a", [] { return std::make_shared<std::string>("one"); }),
      "one");
  EXPECT_EQ(value("a"), 1);
}

TEST_F(KeptContent, KeepsNothingOfWhatCannotBeMade) {
  keepContent(2);
  const auto fail = []() -> std::shared_ptr<int> { throw std::runtime_error("broken file"); };
  EXPECT_THROW(keptContent<int>("number", "a", fail), std::runtime_error);
  EXPECT_EQ(value("a"), 1);
}

}  // namespace
}  // namespace cdiff::core
