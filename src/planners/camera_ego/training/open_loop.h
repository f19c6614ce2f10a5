// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <map>
#include <string>
#include <vector>

#include "learning/curve_log.h"
#include "planners/camera_ego/training/ego_examples.h"

namespace cdiff::planners {

// Open-loop measures of camera egos on held-out moments, as published: distance to where the ego
// was driven (L2) and collisions at 1, 2 and 3 s, in both conventions ("at": at that time, as UniAD
// counts; "to": mean over the waypoints up to it, as VAD counts); detection; map.

/// Box of the ego in losses and measures, as published [m].
inline constexpr double kEgoBoxLength = 4.084;
inline constexpr double kEgoBoxWidth = 1.85;

/// The box of another vehicle at a known waypoint `i`, heading from the place before where it
/// moves.
geometry::OrientedBox futureBox(const AgentLabel& label, std::size_t i);

/// Where a vehicle would be that keeps its velocity.
EgoWaypoints atConstantVelocity(double speed);

/// L2 and collisions of plans.
class PlanMeasures {
 public:
  /// `name`: of the planner in the measures, "" or "constant_velocity_".
  explicit PlanMeasures(std::string name) : name_(std::move(name)) {}
  /// A collision: the box of the ego (4.084 x 1.85 m) at a waypoint, its heading along the plan,
  /// touches that of another vehicle where it was then. Moments at which the driven way itself
  /// touches count for neither, as published.
  void add(const EgoExample& example, const EgoWaypoints& plan);
  /// Adds the moments of another one.
  void merge(const PlanMeasures& other);
  void report(learning::Measures& measures) const;

 private:
  /// Sums by waypoint.
  struct Sums {
    double l2 = 0.0;
    double collisions = 0.0;
    double count = 0.0;  ///< moments with this waypoint
    double free = 0.0;   ///< of these, at which the driven way touches nothing
  };
  std::string name_;
  std::array<Sums, kEgoWaypoints> sums_{};
  double l2_sum_to_[3] = {};  ///< sums over moments of means up to 1, 2, 3 s
  double collisions_to_[3] = {};
  double count_to_[3] = {};
  double free_to_[3] = {};
};

/// A detection of one moment: where (body frame [m]) and how sure.
struct Detection {
  Eigen::Vector2d center = Eigen::Vector2d::Zero();
  double score = 0.0;
};

/// Average precision of detections within 2 m of labels (nuScenes): area below the curve of
/// precision over recall, recall and precision above 10 %.
class DetectionMeasures {
 public:
  static constexpr double kReach = 2.0;  ///< [m]
  /// Each label is found at most once, by the surest detection within reach.
  void add(const EgoExample& example, std::vector<Detection> detections);
  void merge(const DetectionMeasures& other);
  double averagePrecision() const;

 private:
  std::vector<std::pair<double, bool>> found_;  ///< score, whether it is right
  double labels_ = 0.0;
};

/// Detections that are the same at every moment: the mean places of vehicles, as sure as they are
/// often near. What a network must be better than.
class ConstantDetections {
 public:
  /// The `count` cells (2 m) of the BEV in which the most vehicles of `examples` are.
  ConstantDetections(const std::vector<std::vector<Eigen::Vector2d>>& centers, std::size_t count);
  const std::vector<Detection>& detections() const { return detections_; }

 private:
  std::vector<Detection> detections_;
};

/// Mean distance between lines of two sets of the same kind, both ways [m] (Chamfer distance of
/// their points); a set without lines is `kMissing` away.
class MapMeasures {
 public:
  static constexpr double kMissing = 10.0;  ///< [m]; larger distances count as this
  void add(const std::vector<BevLine>& lines, const std::vector<BevLine>& labels);
  void merge(const MapMeasures& other);
  double chamfer() const { return count_ > 0.0 ? sum_ / count_ : 0.0; }

 private:
  double sum_ = 0.0;
  double count_ = 0.0;
};

/// What a straight road along the ego looks like: a lane of 3.5 m with its neighbor and edges. What
/// a network's map must be better than.
std::vector<BevLine> straightRoad(const BevGrid& bev);

}  // namespace cdiff::planners
