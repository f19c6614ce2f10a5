// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// A world for guidance: a road of one lane, 4 m wide, 100 m straight and then bent to the left, a
/// route along its straight part, the planned vehicle 40 m along it and another ahead; turned and
/// moved as a whole.
#pragma once

#include <string>
#include <vector>

#include "core/text.h"
#include "e2e_cdiff/core/random.h"
#include "e2e_cdiff/guidance/objective.h"
#include "support/network_text.h"

namespace cdiff::test {

inline constexpr Eigen::Index kRows = 8;

class GuidanceWorld {
 public:
  /// `frame`: where the road's start and direction lie on the map.
  explicit GuidanceWorld(const geometry::Pose2d& frame = {})
      : frame_(frame), network_(makeNetwork()), area_(network_), route_(makeRoute()) {
    scene_.drivable_area = &area_;
    scene_.route = &route_;
    scene_.route_arc_length = 40.0;
    scene_.state = placed(40.0, 0.0, 0.0, 8.0);
    setOther(52.0, 1.0);
    addTraffic(51.0, 0.4, 0.1);
    addTraffic(44.0, 3.0, 2.8);
  }
  GuidanceWorld(const GuidanceWorld&) = delete;
  GuidanceWorld& operator=(const GuidanceWorld&) = delete;

  guidance::GuidanceScene& scene() { return scene_; }
  guidance::OtherMotion& other() { return other_; }
  const map::RoadNetwork& network() const { return network_; }

  /// A state in the road's frame (x along it, y left) on the map.
  traffic::VehicleState placed(double x, double y, double heading, double speed) const {
    traffic::VehicleState state;
    state.position = frame_.toMap({x, y});
    state.heading = frame_.heading + heading;
    state.speed = speed;
    return state;
  }

  /// The other vehicle stands there, for all rows.
  void setOther(double x, double y) {
    other_.now = placed(x, y, 0.0, 0.0);
    other_.predicted.assign(static_cast<std::size_t>(kRows), other_.now);
    scene_.other = &other_;
  }

  /// One more vehicle stands there, for all rows.
  void addTraffic(double x, double y, double heading) {
    guidance::OtherMotion vehicle;
    vehicle.now = placed(x, y, heading, 0.0);
    vehicle.predicted.assign(static_cast<std::size_t>(kRows), vehicle.now);
    scene_.traffic.push_back(vehicle);
  }

 private:
  std::string point(double x, double y) const {
    const Eigen::Vector2d on_map = frame_.toMap({x, y});
    return core::formatNumber(on_map.x()) + "," + core::formatNumber(on_map.y());
  }
  map::RoadNetwork makeNetwork() const {
    return NetworkText()
        .edge("road", {point(0, 0) + " " + point(100, 0) + " " + point(160, 40)})
        .network();
  }
  map::Route makeRoute() const {
    std::vector<Eigen::Vector3d> points;
    for (int x = 0; x <= 100; ++x) {
      const Eigen::Vector2d on_map = frame_.toMap({static_cast<double>(x), 0.0});
      points.emplace_back(on_map.x(), on_map.y(), 0.0);
    }
    return map::Route(network_, points, std::vector<map::LaneIndex>(points.size(), 0));
  }

  geometry::Pose2d frame_;
  map::RoadNetwork network_;
  map::DrivableArea area_;
  map::Route route_;
  guidance::OtherMotion other_;
  guidance::GuidanceScene scene_;
};

/// Rows at one place of the body frame, with a heading and a speed; actions zero.
inline traffic::Rollout standing(double x, double y, double heading = 0.0, double speed = 0.0,
                                 Eigen::Index rows = kRows) {
  traffic::Rollout rollout = traffic::Rollout::Zero(rows, traffic::kRolloutColumns);
  rollout.col(traffic::kRolloutX).setConstant(x);
  rollout.col(traffic::kRolloutY).setConstant(y);
  rollout.col(traffic::kRolloutHeading).setConstant(heading);
  rollout.col(traffic::kRolloutSpeed).setConstant(speed);
  return rollout;
}

/// A rollout ahead that wanders up to 5 m to the sides, beyond the road's border; every second row
/// is slower than 1 m/s.
inline traffic::Rollout wandering(std::uint32_t trial) {
  const core::RandomStream random(11, "rollout");
  const auto draw = [&](Eigen::Index row, int column, double low, double high) {
    const auto element = static_cast<std::uint32_t>(row * traffic::kRolloutColumns + column);
    return random.uniform({0, trial}, element, low, high);
  };
  traffic::Rollout rollout(kRows, traffic::kRolloutColumns);
  for (Eigen::Index row = 0; row < kRows; ++row) {
    rollout.row(row) << 2.0 * static_cast<double>(row) + draw(row, 0, 0.0, 1.0),
        draw(row, 1, -5.0, 5.0), draw(row, 2, -0.6, 0.6),
        draw(row, 3, 0.0, row % 2 == 0 ? 15.0 : 1.0), draw(row, 4, 0.0, 1.0),
        draw(row, 5, -1.0, 1.0), draw(row, 6, 0.0, 1.0);
  }
  return rollout;
}

/// J alone, of a decision of its own.
inline double valueOf(const guidance::Objective& objective, const guidance::GuidanceScene& scene,
                      const traffic::Rollout& rollout) {
  const auto prepared = objective.clone();
  prepared->prepare(scene);
  traffic::Rollout unused = traffic::Rollout::Zero(rollout.rows(), traffic::kRolloutColumns);
  return prepared->evaluate(scene, rollout, unused);
}

inline traffic::Rollout gradientOf(const guidance::Objective& objective,
                                   const guidance::GuidanceScene& scene,
                                   const traffic::Rollout& rollout) {
  const auto prepared = objective.clone();
  prepared->prepare(scene);
  traffic::Rollout gradient = traffic::Rollout::Zero(rollout.rows(), traffic::kRolloutColumns);
  prepared->evaluate(scene, rollout, gradient);
  return gradient;
}

}  // namespace cdiff::test
