// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "storyboard/expression.h"
#include "support/error_text.h"

namespace cdiff::storyboard {
namespace {

const Parameters kParameters = {{"speed", "10"}, {"name", "car"}, {"zero", "0"}};

std::string errorOf(const std::string& text) {
  return test::errorOf([&] { resolved(text, kParameters); });
}

TEST(Expression, TextsWithoutADollarAndParametersAreTheirValues) {
  EXPECT_EQ(resolved("plain", kParameters), "plain");
  EXPECT_EQ(resolved("$name", kParameters), "car");
}

TEST(Expression, FollowsThePrecedenceOfOperators) {
  EXPECT_EQ(resolved("${1 + 2 * $speed - 4 / 2}", kParameters), "19");
  EXPECT_EQ(resolved("${-(1 + 2) * 3}", kParameters), "-9");
  EXPECT_EQ(resolved("${7 % 4}", kParameters), "3");
  EXPECT_EQ(resolved("${1e-1+0.4}", kParameters), "0.5");
}

TEST(Expression, KnowsItsFunctions) {
  EXPECT_EQ(resolved("${max(pow(2, 3), sqrt(16)) + floor(1.9) + round(0.6)}", kParameters), "10");
  EXPECT_EQ(resolved("${not($zero) and 1}", kParameters), "1");
}

TEST(Expression, WhatCannotBeIsNamed) {
  EXPECT_NE(errorOf("${1 / $zero}").find("divides by zero"), std::string::npos);
  EXPECT_NE(errorOf("$unknown").find("'$unknown' is not declared"), std::string::npos);
  EXPECT_NE(errorOf("${1 +}").find("letter 4"), std::string::npos);
  EXPECT_NE(errorOf("${sqrt(-1)}").find("a finite value of 'sqrt'"), std::string::npos);
  EXPECT_NE(errorOf("${$name + 1}").find("'car'"), std::string::npos);
}

TEST(Expression, ManyBracketsDoNotExhaustTheStack) {
  const std::string deep = "${" + std::string(100000, '(') + "1" + std::string(100000, ')') + "}";
  EXPECT_NE(errorOf(deep).find("fewer nested brackets"), std::string::npos);
}

}  // namespace
}  // namespace cdiff::storyboard
