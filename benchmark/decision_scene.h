// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>
#include <vector>

#include "session/session_setup.h"

namespace cdiff::benchmark {

/// What planners decide on: an ego and CBVs one behind the other along the ego route of a shipped
/// scenario, each with an image of its own, and traffic at fixed places on the lanes around them.
class DecisionScene {
 public:
  static constexpr int kCbvs = 8;  ///< of a scene that names no other number
  /// Planners as in a scenario, empty: the default; `traffic`: further vehicles within 150 m;
  /// `cbvs`: 8 m apart, the first 8 m ahead of the ego, in rows of 16 side by side.
  explicit DecisionScene(const std::string& cbv_planner = "", std::size_t traffic = 0,
                         const std::string& ego_planner = "", int cbvs = kCbvs);

  /// A decision later; every CBV sees something new if asked.
  void advance(bool new_images);
  /// CBVs by number.
  std::vector<planning::PlanningTask> tasks(int first, int count) const;
  /// The ego, with an image of each camera of its rig.
  std::vector<planning::PlanningTask> egoTask() const;
  const session::SessionSetup& setup() const { return setup_; }
  const traffic::TrafficSnapshot& snapshot() const { return snapshot_; }

 private:
  void addRows(int cbvs);
  void addTraffic(std::size_t count);
  void renewImages();

  session::SessionSetup setup_;
  traffic::TrafficSnapshot snapshot_;
  std::vector<traffic::CameraImage> images_;      ///< by CBV
  std::vector<traffic::CameraImage> ego_images_;  ///< by camera
};

}  // namespace cdiff::benchmark
