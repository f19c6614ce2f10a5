// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <limits>

#include "page/pictures/charts.h"

namespace cdiff::page {
namespace {

std::string svgOf(const Chart& chart) { return chartSvg(chart).str(); }

TEST(LineChart, StepsAreOneTwoOrFive) {
  EXPECT_DOUBLE_EQ(niceStep(10.0, 5), 2.0);
  EXPECT_DOUBLE_EQ(niceStep(10.1, 5), 5.0);  // 2.02 is rounded up
  EXPECT_DOUBLE_EQ(niceStep(40.0, 8), 5.0);
  EXPECT_DOUBLE_EQ(niceStep(0.6, 5), 0.2);
  EXPECT_DOUBLE_EQ(niceStep(36.0, 5), 10.0);
}

TEST(LineChart, PlacesPointsOnItsAxesAndBreaksWhereAValueIsMissing) {
  Chart chart;
  chart.title = "a < b";
  chart.duration = 10.0;
  chart.least_top = 10.0;
  const double nothing = std::numeric_limits<double>::quiet_NaN();
  chart.series = {{"ego", {{0.0, 0.0}, {5.0, 10.0}, {6.0, nothing}, {10.0, 0.0}, {10.0, 10.0}}}};
  const std::string svg = svgOf(chart);
  // x from 42 (0 s) to 528 (10 s), y from 166 (0) to 12 (10).
  EXPECT_NE(svg.find("d=\"M42 166L285 12M528 166L528 12\""), std::string::npos) << svg;
  EXPECT_NE(svg.find("a &lt; b"), std::string::npos);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
}

TEST(LineChart, APointWithoutNeighborsIsADot) {
  Chart chart;
  chart.duration = 10.0;
  chart.least_top = 10.0;
  const double nothing = std::numeric_limits<double>::quiet_NaN();
  chart.series = {{"ego", {{5.0, 10.0}}}};
  EXPECT_NE(svgOf(chart).find("<path class=\"series dot ego\" d=\"M285 12h0.01\"/>"),
            std::string::npos)
      << svgOf(chart);
  EXPECT_EQ(svgOf(chart).find("class=\"series ego\""), std::string::npos);
  chart.series = {{"ego", {{0.0, 0.0}, {5.0, 10.0}, {6.0, nothing}, {10.0, 0.0}}}};
  EXPECT_NE(svgOf(chart).find("class=\"series ego\" d=\"M42 166L285 12\""), std::string::npos);
  EXPECT_NE(svgOf(chart).find("class=\"series dot ego\" d=\"M528 166h0.01\""), std::string::npos);
}

TEST(LineChart, ReachesItsHighestValueWithAWholeStep) {
  Chart chart;
  chart.duration = 1.0;
  chart.series = {{"ego", {{0.0, 9.3}}}};  // step 2: the axis ends at 10
  const std::string svg = svgOf(chart);
  EXPECT_NE(svg.find(">10</text>"), std::string::npos);
  EXPECT_EQ(svg.find(">12</text>"), std::string::npos);
}

TEST(LineChart, AxisNumbersStayShort) {
  Chart chart;
  chart.duration = 1.0;
  chart.series = {{"ego", {{0.0, 74000.0}}}};  // step 20000
  EXPECT_NE(svgOf(chart).find(">80k</text>"), std::string::npos);
  chart.series[0].points[0].second = 4.0e6;  // step 1e6
  EXPECT_NE(svgOf(chart).find(">3M</text>"), std::string::npos);
  chart.least_top = 0.0;
  chart.series[0].points[0].second = 6.0e-7;  // step 2e-7
  EXPECT_NE(svgOf(chart).find(">4e-07</text>"), std::string::npos) << svgOf(chart);
}

TEST(LineChart, AChartWithItsOwnTimeIsLeftAloneByTheSlider) {
  Chart chart;
  chart.duration = 3.2;
  EXPECT_NE(svgOf(chart).find("class=\"cursor\""), std::string::npos);
  chart.own_time = true;
  EXPECT_EQ(svgOf(chart).find("class=\"cursor\""), std::string::npos);
  EXPECT_NE(svgOf(chart).find("<figure class=\"chart own\">"), std::string::npos);
}

}  // namespace
}  // namespace cdiff::page
