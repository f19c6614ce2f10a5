// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The closest approach of each CBV to the ego while it was driven: the tick with the smallest gap
/// between their boxes (the first of equals), its whole snapshot, and what planners saw then.
#pragma once

#include <string>
#include <unordered_map>
#include <vector>

#include "session/session_observer.h"

namespace cdiff::record {

struct Approach {
  std::string vehicle_id;
  double gap = 0.0;              ///< between the boxes of ego and CBV [m]
  double center_distance = 0.0;  ///< between their centres [m]
  traffic::TrafficSnapshot snapshot;
  traffic::CameraImage cbv_image;  ///< of the latest decision; empty when its planner does not see
  traffic::CameraImage ego_image;  ///< likewise of the ego

  double time() const { return snapshot.time; }
};

class ApproachLog {
 public:
  /// Every tick in order.
  void observe(const session::TickRecord& record);
  /// In the order in which the vehicles were first driven as CBVs on the ego's level.
  const std::vector<Approach>& approaches() const { return approaches_; }
  /// The approach of a vehicle, or nullptr.
  const Approach* find(const std::string& vehicle_id) const;

 private:
  void compare(const traffic::TrafficSnapshot& snapshot, const traffic::Vehicle& ego,
               const traffic::Vehicle& cbv);
  traffic::CameraImage imageOf(int slot) const;

  std::vector<session::SlotImage> images_;  ///< of the latest decision
  std::vector<Approach> approaches_;
  std::unordered_map<std::string, std::size_t> index_by_id_;
};

}  // namespace cdiff::record
