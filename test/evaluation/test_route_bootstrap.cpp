// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <iostream>

#include "e2e_cdiff/core/random.h"
#include "evaluation/intervals/intervals.h"

namespace cdiff::evaluation {
namespace {

RouteSums meansOf(const std::vector<double>& values) {
  RouteSums sums;
  for (const double value : values) sums.push_back({value, 1.0});
  return sums;
}

TEST(PooledValue, WeighsRoutes) {
  // 1 event in 1 km and 5 in 2 km: 6 / 3.
  EXPECT_DOUBLE_EQ(*pooledValue({{1.0, 1.0}, {5.0, 2.0}}), 2.0);
  EXPECT_FALSE(pooledValue({{0.0, 0.0}}).has_value());
}

TEST(RouteBootstrap, OfTwoRoutesIsTheirRange) {
  // Replicates 0, 1/2, 1 with 1/4, 1/2, 1/4; the tail Phi(-sqrt(2) 12.706) is 0.
  RouteBootstrap bootstrap;
  const auto interval = bootstrap.valueInterval(meansOf({0.0, 1.0}));
  ASSERT_TRUE(interval.has_value());
  EXPECT_DOUBLE_EQ(interval->low, 0.0);
  EXPECT_DOUBLE_EQ(interval->high, 1.0);
}

TEST(RouteBootstrap, OfManyRoutesIsNearStudentsInterval) {
  // 40 values 1 ... 40: mean 20.5, s = sqrt(40 x 41 / 12) = 11.69, t(0.975; 39) = 2.0227: half
  // width 3.739.
  std::vector<double> values;
  for (int i = 1; i <= 40; ++i) values.push_back(i);
  RouteBootstrap bootstrap;
  const auto interval = bootstrap.valueInterval(meansOf(values));
  ASSERT_TRUE(interval.has_value());
  EXPECT_NEAR(interval->low, 20.5 - 3.739, 0.15);
  EXPECT_NEAR(interval->high, 20.5 + 3.739, 0.15);
}

TEST(RouteBootstrap, SaysNothingWithoutSpread) {
  RouteBootstrap bootstrap;
  EXPECT_FALSE(bootstrap.valueInterval(meansOf({3.0})).has_value());
  EXPECT_FALSE(bootstrap.valueInterval(meansOf({0.1, 0.1, 0.1})).has_value());
  EXPECT_FALSE(bootstrap.differenceInterval(meansOf({1, 5}), meansOf({2, 6})).has_value());
}

TEST(RouteBootstrap, StaysWithinTheValues) {
  RouteBootstrap bootstrap;
  const auto interval = bootstrap.valueInterval(meansOf({100, 100, 100, 100, 70}));
  ASSERT_TRUE(interval.has_value());
  EXPECT_LE(interval->high, 100.0);
  EXPECT_GE(interval->low, 70.0);
}

TEST(RouteBootstrap, TakesTheSameRoutesOnBothSides) {
  // B = A + 1 +- 0.1 on routes that are far apart: the difference's interval does not see how far.
  RouteBootstrap bootstrap;
  const auto interval = bootstrap.differenceInterval(
      meansOf({0, 50, 100, 150, 200, 250}), meansOf({1.1, 50.9, 101.1, 150.9, 201.1, 250.9}));
  ASSERT_TRUE(interval.has_value());
  EXPECT_GE(interval->low, 0.9 - 1e-9);
  EXPECT_LE(interval->high, 1.1 + 1e-9);
}

TEST(RouteBootstrap, IsTheSameEachTime) {
  RouteBootstrap first;
  RouteBootstrap second;
  second.valueInterval(meansOf({1.0, 9.0}));  // other draws before
  const RouteSums routes = meansOf({1.0, 4.0, 2.0, 8.0});
  EXPECT_DOUBLE_EQ(first.valueInterval(routes)->low, second.valueInterval(routes)->low);
  EXPECT_DOUBLE_EQ(first.valueInterval(routes)->high, second.valueInterval(routes)->high);
}

/// Values of 5 seeds on each of `routes` routes: the route's part and the seed's part are normal.
std::vector<std::vector<double>> drawnRoutes(std::uint32_t world, std::size_t routes,
                                             double route_deviation, double seed_deviation) {
  const core::RandomStream stream(7, "coverage");
  std::vector<std::vector<double>> values(routes);
  std::uint32_t element = 0;
  for (auto& seeds : values) {
    const double route = route_deviation * stream.normal({0, world, 0}, element++);
    for (int i = 0; i < 5; ++i)
      seeds.push_back(route + seed_deviation * stream.normal({0, world, 0}, element++));
  }
  return values;
}

TEST(RouteBootstrap, CoversTheTruthWhereRunsAreAlikeAndANaiveOneDoesNot) {
  // Truth 0; runs of a route share most of their value. Of 400 worlds 95 % are 380, with a standard
  // deviation of sqrt(400 x 0.95 x 0.05) = 4.4: clustered within 6 of these, while the interval
  // that takes runs for independent is far too narrow (half width about 1 / sqrt(5) of what it must
  // be).
  RouteBootstrap bootstrap;
  int clustered = 0;
  int naive = 0;
  for (std::uint32_t world = 0; world < 400; ++world) {
    RouteSums routes;
    RouteSums runs;
    for (const auto& seeds : drawnRoutes(world, 12, 1.0, 0.2)) {
      routes.push_back({0.0, 0.0});
      for (const double value : seeds) {
        routes.back().sum += value;
        routes.back().weight += 1.0;
        runs.push_back({value, 1.0});
      }
    }
    const Interval wide = *bootstrap.valueInterval(routes);
    const Interval narrow = *bootstrap.valueInterval(runs);
    EXPECT_GT(wide.high - wide.low, narrow.high - narrow.low);
    clustered += wide.low <= 0.0 && 0.0 <= wide.high;
    naive += narrow.low <= 0.0 && 0.0 <= narrow.high;
  }
  EXPECT_NEAR(clustered, 380, 26);
  EXPECT_LT(naive, 300);
}

/// Share of 1,000 worlds whose interval of 16 routes holds the mean; routes without spread count as
/// held, since bounded figures have an interval by unseen routes then.
double coverage(double truth,
                const std::function<double(const core::RandomStream&, const core::RandomKey&,
                                           std::uint32_t)>& draw) {
  const core::RandomStream stream(11, "coverage");
  RouteBootstrap bootstrap;
  int held = 0;
  for (std::uint32_t world = 0; world < 1000; ++world) {
    RouteSums routes;
    for (std::uint32_t i = 0; i < 16; ++i) routes.push_back({draw(stream, {0, world, 0}, i), 1.0});
    const auto interval = bootstrap.valueInterval(routes);
    held += !interval || (interval->low <= truth && truth <= interval->high);
  }
  return held / 1000.0;
}

TEST(RouteBootstrap, HoldsRareFailuresLessOften) {
  // Normal routes: 950 of 1,000 with a standard deviation of 6.9. 0 on 80 % of the routes and
  // exponential with mean 10 on the others (mean 2): fewer, which docs/statistics.md says.
  const double normal = coverage(0.0, [](const auto& stream, const auto& key, std::uint32_t i) {
    return stream.normal(key, i);
  });
  const double rare = coverage(2.0, [](const auto& stream, const auto& key, std::uint32_t i) {
    const bool fails = stream.uniform(key, 2 * i) < 0.2;
    return fails ? -10.0 * std::log(1.0 - stream.uniform(key, 2 * i + 1)) : 0.0;
  });
  std::cout << "coverage of 16 routes: normal " << normal << ", rare failures " << rare << "\n";
  EXPECT_NEAR(normal, 0.95, 0.03);
  EXPECT_NEAR(rare, 0.85, 0.06);
}

TEST(ExchangeTest, CountsTheWays) {
  // Differences 1, 2, 3: only all signs alike reach |6|: 2 of 8.
  EXPECT_DOUBLE_EQ(exchangeTest(meansOf({0, 0, 0}), meansOf({1, 2, 3})), 0.25);
  // Differences 1, 1, -1: |1| or more for all 8.
  EXPECT_DOUBLE_EQ(exchangeTest(meansOf({0, 0, 1}), meansOf({1, 1, 0})), 1.0);
  EXPECT_DOUBLE_EQ(exchangeTest(meansOf({4, 5}), meansOf({4, 5})), 1.0);
}

TEST(ExchangeTest, DrawsWaysWhereThereAreManyRoutes) {
  // 20 differences of 1: 2 of 2^20 ways are as large, so that almost no drawn one is.
  const std::vector<double> zeros(20, 0.0);
  const std::vector<double> ones(20, 1.0);
  EXPECT_LE(exchangeTest(meansOf(zeros), meansOf(ones)), 2.0 / 20000.0);
}

}  // namespace
}  // namespace cdiff::evaluation
