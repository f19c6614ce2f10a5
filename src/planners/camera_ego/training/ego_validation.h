// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "planners/camera_ego/training/open_loop.h"

namespace cdiff::planners {

/// What a camera ego answered at one moment, as far as it is measured.
struct EgoAnswer {
  EgoWaypoints plan;
  std::vector<Detection> detections;
  std::vector<BevLine> lines;
};

/// The open-loop measures of a camera ego, and beside them those of what it must beat: a vehicle
/// that keeps its velocity, detections that never change, and a straight road.
class EgoMeasures {
 public:
  void add(const EgoExample& example, const EgoAnswer& answer, const ConstantDetections& prior,
           const BevGrid& bev);
  void merge(const EgoMeasures& other);
  void report(learning::Measures& measures) const;
  double moments() const { return moments_; }

 private:
  double moments_ = 0.0;
  PlanMeasures plan_{""};
  PlanMeasures constant_{"constant_velocity_"};
  DetectionMeasures detection_;
  DetectionMeasures prior_detection_;
  MapMeasures map_;
  MapMeasures straight_;
};

/// The measures of held-out moments with 95 % intervals, since moments of one network are alike, by
/// a bootstrap that draws whole networks (expanded percentile: Hesterberg 2015, The American
/// Statistician 69, 371-386, section 5.3). Fewer than three networks give no intervals.
class EgoValidation {
 public:
  static constexpr std::size_t kReplicates = 1000;

  void add(const EgoExample& example, const EgoAnswer& answer, const ConstantDetections& prior,
           const BevGrid& bev) {
    by_network_[example.network].add(example, answer, prior, bev);
  }
  /// NAME, and where there are intervals NAME_low and NAME_high; NAME_gain, NAME_gain_low and
  /// NAME_gain_high: by how much it is better than what it must beat, paired by network.
  learning::Measures measures() const;
  /// The measures of each network as CSV: network,moments,measure,value. Networks are numbered in
  /// one order for all that are judged on the same data, so that two can be compared in pairs.
  std::string byNetwork() const;

 private:
  std::map<std::uint64_t, EgoMeasures> by_network_;
};

/// The measures as Markdown. `title`: of the planner.
std::string egoTable(const learning::Measures& held_out, const std::string& title);

}  // namespace cdiff::planners
