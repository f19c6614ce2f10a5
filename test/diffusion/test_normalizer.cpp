// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <limits>

#include "diffusion/normalizer.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::diffusion {
namespace {

/// Two rows; mean 0, 1, ... 13 and scale 1, 2, ... 14 in row-major order.
Normalizer counting() {
  Normalizer normalizer{traffic::Rollout(2, 7), traffic::Rollout(2, 7)};
  for (int i = 0; i < 14; ++i) {
    normalizer.mean.data()[i] = i;
    normalizer.scale.data()[i] = i + 1;
  }
  return normalizer;
}

TEST(Normalizer, EveryCellHasItsOwnMeanAndScale) {
  // (10 - 0) / 1 = 10 in the first cell; (10 - 9) / 10 = 0.1 in row 1, column 2.
  const traffic::Rollout metric = traffic::Rollout::Constant(2, 7, 10.0);
  const Trajectory normalized = counting().normalize(metric);
  EXPECT_EQ(normalized(0, 0), 10.0F);
  EXPECT_EQ(normalized(1, 2), 0.1F);
  EXPECT_EQ(normalized(1, 6), -3.0F / 14.0F);
}

TEST(Normalizer, RoundTrip) {
  // Values up to 25 keep 24 bits on the way: off by at most 14 x 2^-24 x (largest normalized) 12.
  traffic::Rollout metric(2, 7);
  for (int i = 0; i < 14; ++i) metric.data()[i] = 12.3 - 0.7 * i;
  const traffic::Rollout back = counting().denormalize(counting().normalize(metric));
  EXPECT_LT((back - metric).cwiseAbs().maxCoeff(), 1e-5);
  EXPECT_GT((back - counting().mean).cwiseAbs().maxCoeff(), 1.0);
}

TEST(Normalizer, GradientIsMultipliedByTheScale) {
  // metric = normalized x scale + mean, so dJ/dnormalized = 3 x (i + 1).
  const traffic::Rollout gradient = traffic::Rollout::Constant(2, 7, 3.0);
  const Trajectory normalized = counting().toNormalizedGradient(gradient);
  for (int i = 0; i < 14; ++i) EXPECT_EQ(normalized.data()[i], static_cast<float>(3 * (i + 1)));
}

std::string errorOf(const Normalizer& normalizer, int horizon) {
  try {
    normalizer.validate(horizon);
  } catch (const core::InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Normalizer, ValidateNamesTheCell) {
  EXPECT_EQ(errorOf(counting(), 2), "");
  EXPECT_NE(errorOf(counting(), 3).find("mean has 2 rows; T = 3"), std::string::npos);
  Normalizer zero = counting();
  zero.scale(1, 4) = 0.0;
  EXPECT_NE(errorOf(zero, 2).find("scale of row 1, column 4 is 0"), std::string::npos);
  Normalizer negative = counting();
  negative.scale(0, 6) = -1.5;
  EXPECT_NE(errorOf(negative, 2).find("scale of row 0, column 6 is -1.5"), std::string::npos);
  Normalizer infinite = counting();
  infinite.scale(0, 0) = std::numeric_limits<double>::infinity();
  EXPECT_NE(errorOf(infinite, 2).find("scale of row 0, column 0 is inf"), std::string::npos);
  Normalizer nan = counting();
  nan.mean(1, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(errorOf(nan, 2).find("mean of row 1, column 0 is nan"), std::string::npos);
}

std::string errorOf(const std::string& text) {
  try {
    Normalizer::fromJson(text, 2, "normalizer");
  } catch (const core::InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Normalizer, IsReadAsItWasWritten) {
  const std::string text = counting().toJson();
  const Normalizer read = Normalizer::fromJson(text, 2, "normalizer");
  EXPECT_EQ(read.mean, counting().mean);
  EXPECT_EQ(read.scale, counting().scale);
  const std::string row = "[0,1,2,3,4,5,6]";
  const std::string rows = "[" + row + "," + row + "]";
  const auto with = [&](const std::string& mean) {
    return errorOf("{\"mean\":" + mean + ",\"scale\":" + rows + "}");
  };
  EXPECT_EQ(with(rows), "");
  const std::string rows_expected = "; T = 2 rows were expected";
  EXPECT_NE(with("[" + row + "]").find("an array of 1" + rows_expected), std::string::npos)
      << with("[" + row + "]");
  EXPECT_NE(with("3").find(rows_expected), std::string::npos);
  EXPECT_NE(with("{\"a\":1,\"b\":2}").find(rows_expected), std::string::npos);
  EXPECT_NE(with("[" + row + ",[1,2]]").find("row 1: 7 numbers"), std::string::npos);
  EXPECT_NE(with("[" + row + ",7]").find("row 1: 7 numbers"), std::string::npos);
  EXPECT_NE(with("[[0,1,2,true,4,5,6]," + row + "]").find("row 0, column 3"), std::string::npos);
  const std::string object_expected = "an object of mean and scale was expected";
  for (const std::string wrong : {"[1,2]", "{\"mean\":1}", "{\"mean\":1,\"scales\":2}",
                                  "{\"means\":1,\"scale\":2}", "{\"mean\":1,\"scale\":2,\"x\":3}"})
    EXPECT_NE(errorOf(wrong).find(object_expected), std::string::npos) << wrong;
}

}  // namespace
}  // namespace cdiff::diffusion
