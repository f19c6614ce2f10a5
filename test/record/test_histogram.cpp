// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <limits>

#include "page/pictures/charts.h"
#include "record/logs/driving_log.h"
#include "record/sample_session.h"

namespace cdiff::record {
namespace {

TEST(Histogram, CountsAndKeepsMeanAndDeviation) {
  Histogram sample(-1.0, 0.5, 4);  // [-1, -0.5), [-0.5, 0), [0, 0.5), [0.5, 1)
  for (const double value : {-1.0, -0.5, 0.0, 0.25, 7.0, -9.0}) sample.add(value);
  sample.add(std::numeric_limits<double>::quiet_NaN());
  sample.add(std::numeric_limits<double>::infinity());
  EXPECT_EQ(sample.counts(),
            (std::vector<std::size_t>{2, 1, 2, 1}));  // the ends hold what is beyond
  EXPECT_EQ(sample.n(), 6u);
  // Sum -3.25; squares 1 + 0.25 + 0 + 0.0625 + 49 + 81 = 131.3125.
  const double mean = -3.25 / 6.0;
  EXPECT_NEAR(*sample.mean(), mean, 1e-12);
  EXPECT_NEAR(*sample.standardDeviation(), std::sqrt((131.3125 - 6.0 * mean * mean) / 5.0), 1e-12);
  EXPECT_NEAR(sample.share(2), 2.0 / 6.0, 1e-15);
}

TEST(Histogram, AnEmptySampleHasNoStatistics) {
  Histogram sample(0.0, 1.0, 3);
  EXPECT_FALSE(sample.mean().has_value());
  EXPECT_EQ(sample.share(0), 0.0);
  sample.add(1.5);
  EXPECT_DOUBLE_EQ(*sample.mean(), 1.5);
  EXPECT_FALSE(sample.standardDeviation().has_value());
}

TEST(HistogramChart, DrawsBarsInPercentOfEachSample) {
  Histogram first(0.0, 1.0, 10);
  Histogram second(0.0, 1.0, 10);
  first.add(4.5);
  second.add(4.5);
  second.add(5.5);
  const std::string svg =
      page::histogramSvg({"Speed", "m/s", {{"a", &first}, {"b", &second}}}, "<all>").str();
  // Bins 4 and 5 fill the width, 42 to 528 pixels; 100 % lies at 12, 50 % at 89, 0 at 166 pixels.
  EXPECT_NE(svg.find("<path class=\"bars a\" d=\"M42 166V12H285V166H528V166Z\"/>"),
            std::string::npos)
      << svg;
  EXPECT_NE(svg.find("<path class=\"bars b\" d=\"M42 166V89H285V89H528V166Z\"/>"),
            std::string::npos)
      << svg;
  EXPECT_NE(svg.find("&lt;all&gt;"), std::string::npos);
}

TEST(HistogramChart, EmptySamplesLeaveAnEmptyChart) {
  const Histogram nothing(-1.0, 1.0, 2);
  const std::string svg = page::histogramSvg({"Speed", "m/s", {{"a", &nothing}}}, "none").str();
  EXPECT_EQ(svg.find("bars a"), std::string::npos);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
}

TEST(DrivingLog, DistinguishesCbvsFromBackgroundAtDecisions) {
  DrivingLog log;
  for (std::uint64_t tick = 0; tick <= 60; ++tick) log.observe(test::sampleSnapshot(tick));
  // 31 decisions; bg_1 is a CBV after tick 52: at 54, 56, 58 and 60. bg_2 never is.
  EXPECT_EQ(log.cbv().speed.n(), 4u);
  EXPECT_EQ(log.background().speed.n(), 31u + 27u);
  EXPECT_EQ(log.cbv().speed.counts()[12], 4u);          // 6 m/s
  EXPECT_EQ(log.background().speed.counts()[20], 31u);  // 10 m/s
  EXPECT_EQ(log.cbv().acceleration.counts()[32], 4u);   // 0 m/s^2
}

}  // namespace
}  // namespace cdiff::record
