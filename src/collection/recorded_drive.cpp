// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "collection/recorded_drive.h"

#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::collection {

void DriveOptions::describe(core::OptionsVisitor& visitor) {
  visitor.text({"image", "", "Topic of the front camera's images."}, image, {});
  visitor.text({"odometry", "", "Topic of the vehicle's nav_msgs/Odometry."}, odometry, {});
  visitor.text({"control", "", "Topic of e2e_cdiff/ControlAction; empty: inferred."}, control, {});
  visitor.text({"path", "", "Topic of the route as nav_msgs/Path; empty: the way driven."}, path,
               {});
  visitor.number({"period", "s", "Time between samples."}, period, 0.05, 60.0);
  visitor.number({"largest_gap", "s", "Longest gap of odometry and controls in a sample."},
                 largest_gap, 0.01, 10.0);
}

void DriveOptions::validate() const {
  const auto require = [](const char* key, const std::string& topic) {
    if (topic.empty()) throw core::InputError(std::string("topics: ") + key + " is not given");
  };
  require("image", image);
  require("odometry", odometry);
}

std::optional<traffic::VehicleState> RecordedDrive::stateAt(double time, double largest_gap) const {
  const auto after = states.lower_bound(time);
  if (after == states.end()) return std::nullopt;
  if (after->first == time) return after->second;
  if (after == states.begin()) return std::nullopt;
  const auto before = std::prev(after);
  if (after->first - before->first > largest_gap) return std::nullopt;
  const double share = (time - before->first) / (after->first - before->first);
  const traffic::VehicleState& a = before->second;
  const traffic::VehicleState& b = after->second;
  traffic::VehicleState state = a;
  state.position += share * (b.position - a.position);
  state.elevation += share * (b.elevation - a.elevation);
  state.heading = core::wrapAngle(a.heading + share * core::angleDifference(b.heading, a.heading));
  state.speed += share * (b.speed - a.speed);
  return state;
}

std::optional<traffic::ControlAction> RecordedDrive::controlAt(double time,
                                                               double largest_gap) const {
  const auto after = controls.upper_bound(time);
  if (after == controls.begin()) return std::nullopt;
  const auto before = std::prev(after);
  if (time - before->first > largest_gap) return std::nullopt;
  return before->second;
}

}  // namespace cdiff::collection
