// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "e2e_cdiff/core/angle.h"
#include "metrics/formulas/post_encroachment.h"
#include "metrics/metric_under_test.h"

namespace cdiff::metrics {
namespace {

constexpr double kStep = 0.05;

/// A vehicle of 4.8 m x 1.8 m that drives straight on from (x, y).
struct Drive {
  double x = 0.0;
  double y = 0.0;
  double heading_degrees = 0.0;
  double speed = 0.0;
  double elevation = 0.0;

  traffic::Vehicle at(double time, traffic::Vehicle vehicle) const {
    vehicle.state.heading = core::degreesToRadians(heading_degrees);
    vehicle.state.speed = speed;
    vehicle.state.position =
        Eigen::Vector2d(x, y) + time * speed * geometry::direction(vehicle.state.heading);
    vehicle.state.elevation = elevation;
    return vehicle;
  }
};

/// What the metric says of one CBV.
struct PostEncroachment {
  std::string vehicle_id;
  std::optional<double> seconds;
  bool ego_first = false;
  std::string reason;
};

/// The metric by itself.
class PostEncroachmentTimes {
 public:
  explicit PostEncroachmentTimes(double limit) : metric_("post_encroachment", optionsOf(limit)) {}

  void observe(const traffic::TrafficSnapshot& snapshot) {
    MetricTick tick{snapshot, nullptr, snapshot.ego()};
    for (const traffic::Vehicle& vehicle : snapshot.vehicles) {
      if (vehicle.role == traffic::VehicleRole::kCbv) tick.cbvs.push_back({&vehicle});
    }
    metric_.observe(tick);
  }
  Measure mean() { return metric_.at("post_encroachment_mean_s"); }
  Measure at(const std::string& name) { return metric_.at(name); }
  std::vector<PostEncroachment> times() {
    std::vector<PostEncroachment> all;
    for (const MetricEntry& entry : metric_.list("/cbv/post_encroachments")) {
      all.emplace_back();
      for (const auto& [key, value] : entry) {
        if (key == "vehicle_id") all.back().vehicle_id = std::get<std::string>(value);
        if (key == "reason") all.back().reason = std::get<std::string>(value);
        if (key == "seconds" && std::holds_alternative<double>(value))
          all.back().seconds = std::get<double>(value);
        if (key == "first" && std::holds_alternative<std::string>(value))
          all.back().ego_first = std::get<std::string>(value) == "ego";
      }
    }
    return all;
  }

 private:
  static SessionMetricsOptions optionsOf(double limit) {
    SessionMetricsOptions options;
    options.post_encroachment_limit = limit;
    return options;
  }
  test::MetricUnderTest metric_;
};

PostEncroachmentTimes driven(const Drive& ego, const Drive& cbv, int ticks, double limit = 10.0) {
  PostEncroachmentTimes times(limit);
  for (int tick = 0; tick <= ticks; ++tick) {
    const double time = kStep * tick;
    times.observe(
        test::snapshot(static_cast<std::uint64_t>(tick),
                       {ego.at(time, test::ego(0, 0, 0)), cbv.at(time, test::cbv("a", 0, 0, 0))}));
  }
  return times;
}

TEST(PostEncroachmentTimes, IsExitToEntryOfTheAreaWherePathsCrossAtRightAngles) {
  // The ego's rear passes the CBV's far side, y = 0.9, with its center at 3.3 m: 23.3 m at 10 m/s,
  // 2.33 s. The CBV's front comes to x = -0.9 with its center at -3.3 m: 36.7 m at 9 m/s, 4.0778 s.
  auto times = driven({0, -20, 90, 10}, {-40, 0, 0, 9}, 200);
  const std::vector<PostEncroachment> all = times.times();
  ASSERT_EQ(all.size(), 1U);
  EXPECT_EQ(all[0].vehicle_id, "a");
  EXPECT_NEAR(*all[0].seconds, 36.7 / 9.0 - 2.33, 1e-9);
  EXPECT_TRUE(all[0].ego_first);
  EXPECT_NEAR(*times.mean().value, 36.7 / 9.0 - 2.33, 1e-9);
  EXPECT_EQ(times.mean().n, 1U);
}

TEST(PostEncroachmentTimes, SaysWhoWasFirst) {
  const auto all = driven({-40, 0, 0, 9}, {0, -20, 90, 10}, 200).times();
  EXPECT_NEAR(*all[0].seconds, 36.7 / 9.0 - 2.33, 1e-9);
  EXPECT_FALSE(all[0].ego_first);
}

TEST(PostEncroachmentTimes, IsTheNetTimeGapOfOneBehindTheOther) {
  // 20 m of centers, 15.2 m between bumpers, both at 8 m/s: 1.9 s.
  const auto all = driven({20, 0, 0, 8}, {0, 0, 0, 8}, 200).times();
  EXPECT_NEAR(*all[0].seconds, 1.9, 1e-9);
  EXPECT_TRUE(all[0].ego_first);
}

// All at 8 m/s, centers 20 and 36 m behind the ego's, 15.2 and 31.2 m between bumpers: 1.9 and
// 3.9 s.
TEST(PostEncroachmentTimes, HaveMeanDeviationAndMinimumOverCbvs) {
  PostEncroachmentTimes times(10.0);
  for (int tick = 0; tick <= 200; ++tick) {
    const double time = kStep * tick;
    times.observe(test::snapshot(static_cast<std::uint64_t>(tick),
                                 {Drive{36, 0, 0, 8}.at(time, test::ego(0, 0, 0)),
                                  Drive{16, 0, 0, 8}.at(time, test::cbv("a", 0, 0, 0)),
                                  Drive{0, 0, 0, 8}.at(time, test::cbv("b", 0, 0, 0))}));
  }
  EXPECT_NEAR(*times.mean().value, 2.9, 1e-9);
  EXPECT_NEAR(*times.at("post_encroachment_std_s").value, std::sqrt(2.0), 1e-9);
  EXPECT_NEAR(*times.at("post_encroachment_min_s").value, 1.9, 1e-9);
}

TEST(PostEncroachmentTimes, IsZeroForAContact) {
  EXPECT_EQ(*driven({0, -20, 90, 10}, {-20, 0, 0, 10}, 60).times()[0].seconds, 0.0);
}

TEST(PostEncroachmentTimes, IsAbsentWhereTheyShareNoPlace) {
  auto beside = driven({0, 0, 0, 8}, {0, 3.5, 0, 8}, 100);
  EXPECT_FALSE(beside.times()[0].seconds.has_value());
  EXPECT_EQ(beside.times()[0].reason, "ego and CBV were never at one place within 10 s");
  EXPECT_FALSE(beside.mean().value.has_value());
  EXPECT_EQ(beside.mean().reason, "no CBV was ever at one place with the ego within 10 s");
  Drive above{-40, 0, 0, 9};
  above.elevation = 6.0;
  EXPECT_FALSE(driven({0, -20, 90, 10}, above, 200).times()[0].seconds.has_value());
}

TEST(PostEncroachmentTimes, IsAbsentAboveTheLimit) {
  const Drive ego{0, -20, 90, 10};
  const Drive cbv{-40, 0, 0, 9};  // 1.748 s
  EXPECT_TRUE(driven(ego, cbv, 200, 1.8).times()[0].seconds.has_value());
  EXPECT_FALSE(driven(ego, cbv, 200, 1.7).times()[0].seconds.has_value());
}

/// Smallest time between samples of the two drives, 0.01 s apart, whose boxes overlap.
std::optional<double> sampledTime(const Drive& ego, const Drive& cbv, double duration) {
  constexpr double kFine = 0.01;
  const int count = static_cast<int>(duration / kFine);
  std::vector<geometry::OrientedBox> egos;
  std::vector<geometry::OrientedBox> cbvs;
  for (int i = 0; i <= count; ++i) {
    egos.push_back(ego.at(kFine * i, test::ego(0, 0, 0)).box());
    cbvs.push_back(cbv.at(kFine * i, test::cbv("a", 0, 0, 0)).box());
  }
  for (int gap = 0; gap <= count; ++gap) {
    for (int i = 0; i + gap <= count; ++i) {
      if (geometry::overlap(egos[i], cbvs[i + gap]) || geometry::overlap(egos[i + gap], cbvs[i]))
        return kFine * gap;
    }
  }
  return std::nullopt;
}

TEST(PostEncroachmentTimes, AgreeWithDenseSamplesOnObliquePaths) {
  // A sampled exit is at most one sample early, a sampled entry at most one late: 0 to 0.02 s more.
  std::size_t defined = 0;
  for (int i = 0; i < 24; ++i) {
    const Drive ego{-30.0, -3.0 + 0.25 * i, 4.0 * i, 7.0 + 0.2 * i};
    const Drive cbv{20.0 - i, -25.0 + 2.0 * i, 100.0 + 11.0 * i, 9.0 - 0.1 * i};
    const auto seconds = driven(ego, cbv, 120).times()[0].seconds;
    const auto sampled = sampledTime(ego, cbv, 6.0);
    ASSERT_EQ(seconds.has_value(), sampled.has_value()) << i;
    if (!seconds) continue;
    ++defined;
    EXPECT_LE(*seconds, *sampled + 1e-9) << i;
    EXPECT_GE(*seconds, *sampled - 0.02 - 1e-9) << i;
  }
  EXPECT_GE(defined, 6U);
}

TEST(PostEncroachmentTimes, RemembersWhereAReleasedCbvDrove) {
  // The CBV crosses first and is then released; the ego comes 2.1 s behind it.
  PostEncroachmentTimes times(10.0);
  const Drive cbv{0, -20, 90, 10};
  const Drive ego{-40, 0, 0, 9};
  for (int tick = 0; tick <= 120; ++tick) {
    const double time = kStep * tick;
    const auto as = tick < 60 ? test::cbv("a", 0, 0, 0) : test::background("a", 0, 0, 0);
    times.observe(test::snapshot(static_cast<std::uint64_t>(tick),
                                 {ego.at(time, test::ego(0, 0, 0)), cbv.at(time, as)}));
  }
  EXPECT_NEAR(*times.times()[0].seconds, 36.7 / 9.0 - 2.33, 1e-9);
}

TEST(PostEncroachmentTimes, NamesTheReasonWithoutCbv) {
  PostEncroachmentTimes times(10.0);
  EXPECT_TRUE(times.times().empty());
  EXPECT_EQ(times.mean().reason, "no CBV was driven");
}

TEST(TimesBetween, GivesTheRangeOfASharedPlace) {
  // The first stands at the origin during [0, 1], the second drives onto it with 10 m/s during
  // [5, 6]: from 8.8 m to -1.2 m of centers, contact from 4.8 m on: u >= 0.4, so 5.4 - 1 at the
  // shortest; 6 - 0 at the longest.
  SweptBox standing;
  standing.box = {{0, 0}, 0.0, 4.8, 1.8};
  standing.duration = 1.0;
  SweptBox second = standing;
  second.box.center = {8.8, 0.0};
  second.offset = {-10.0, 0.0};
  second.begin = 5.0;
  const auto range = timesBetween(standing, second);
  ASSERT_TRUE(range.has_value());
  EXPECT_NEAR(range->shortest, 4.4, 1e-12);
  EXPECT_NEAR(range->longest, 6.0, 1e-12);
  second.box.center = {20.0, 0.0};
  EXPECT_FALSE(timesBetween(standing, second).has_value());
}

}  // namespace
}  // namespace cdiff::metrics
