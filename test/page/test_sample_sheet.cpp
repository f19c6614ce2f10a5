// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "learning/small_samples.h"
#include "page/training_pages.h"

namespace cdiff::page {
namespace {

std::size_t count(const std::string& text, const std::string& word) {
  std::size_t times = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1))
    ++times;
  return times;
}

class SampleSheet : public testing::Test {
 protected:
  /// 40 samples: maneuvers 0 to 3 in turn, those of 5 to 7 m/s middle, from 9 m/s on fast.
  SampleSheet() {
    learning::DrivingShardWriter writer(test::smallSchema());
    for (std::size_t i = 0; i < 40; ++i) writer.append(test::smallSample(i % 8, i));
    writer.write(folder_.path() / "a.shard");
  }
  test::TemporaryFolder folder_;
};

TEST_F(SampleSheet, ChoosesSomeOfEveryKind) {
  const learning::Dataset stored(folder_.path(), 0.0);
  const learning::DrivingDataset dataset(stored);
  std::size_t all = 0;
  for (const auto& [kind, indices] : samplesByKind(dataset, 2)) {
    EXPECT_LE(indices.size(), 2U) << kind;
    EXPECT_GE(indices.size(), 1U) << kind;
    all += indices.size();
  }
  EXPECT_EQ(samplesByKind(dataset, 2).size(), samplesByKind(dataset, 1000).size());
  std::size_t whole = 0;
  for (const auto& [kind, indices] : samplesByKind(dataset, 1000)) whole += indices.size();
  EXPECT_EQ(whole, 40U);
  EXPECT_LT(all, whole);
}

TEST_F(SampleSheet, ShowsImageAndRouteOfEach) {
  const learning::Dataset stored(folder_.path(), 0.0);
  const learning::DrivingDataset dataset(stored);
  const std::string page = sampleSheet("data <a>", {{"samples", "40", ""}}, dataset, 1);
  const std::size_t kinds = samplesByKind(dataset, 1).size();
  EXPECT_EQ(count(page, "<figure"), kinds);
  EXPECT_EQ(count(page, "data:image/png;base64,"), kinds);
  EXPECT_EQ(count(page, "class=\"driven\""), kinds);
  EXPECT_NE(page.find("data &lt;a&gt;"), std::string::npos);
  EXPECT_NE(page.find("<td>samples</td><td>40</td>"), std::string::npos);
}

}  // namespace
}  // namespace cdiff::page
