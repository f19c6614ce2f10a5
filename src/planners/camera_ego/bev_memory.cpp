// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/camera_ego/bev_memory.h"

#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "e2e_cdiff/core/angle.h"

namespace cdiff::planners {

BevMemory::BevMemory(double period)
    : period_(period), age_(static_cast<std::size_t>(std::lround(kPastAge / period))) {}

EgoPoses BevMemory::posesAt(const traffic::VehicleState& state) const {
  EgoPoses poses{state.pose(), std::nullopt};
  if (kept_.size() >= age_) poses.past = kept_[kept_.size() - age_].pose;
  return poses;
}

EgoMotion BevMemory::motionAt(const traffic::VehicleState& state, const EgoPoses& poses) const {
  const double turned =
      kept_.empty() ? 0.0 : core::wrapAngle(state.heading - kept_.back().pose.heading);
  return egoMotion(state.speed, turned / period_, poses);
}

const inference::Rows* BevMemory::past() const {
  return kept_.size() >= age_ ? &kept_[kept_.size() - age_].bev : nullptr;
}

void BevMemory::keep(const traffic::VehicleState& state, const inference::Rows& bev,
                     std::int64_t width) {
  Kept kept;
  if (kept_.size() >= age_) {
    kept = std::move(kept_.front());  // its memory serves again
    kept_.pop_front();
  }
  kept.pose = state.pose();
  kept.bev.resize(bev.rows(), width);
  for (std::int64_t row = 0; row < bev.rows(); ++row)
    std::copy_n(bev.row(row), width, kept.bev.row(row));
  kept_.push_back(std::move(kept));
}

RigWatch::RigWatch(const rendering::CameraRig& rig, double frozen_image_time,
                   double simulation_step)
    : names_(rig.names()), watches_(rig.cameras.size()) {
  constexpr double kNever = 1e9;  // [s]
  for (const rendering::RigCamera& camera : rig.cameras)
    expectations_.push_back(
        {static_cast<int>(camera.width), static_cast<int>(camera.height), kNever, simulation_step});
  expected_strip_ = expectations_.front();
  expected_strip_.frozen_image_time = rig.blind ? kNever : frozen_image_time;
  expected_strip_.height *= static_cast<int>(rig.cameras.size());
}

std::string RigWatch::fault(const planning::PlanningTask& task, std::uint64_t tick) {
  std::string first;
  for (std::size_t i = 0; i < names_.size(); ++i) {
    const auto fault =
        watches_[i].fault(expectations_[i], task.views.find(names_[i]), task.vehicle->state, tick);
    if (fault && first.empty()) first = "camera '" + names_[i] + "': " + *fault;
  }
  if (!first.empty()) return first;
  traffic::CameraImage strip{expected_strip_.width, expected_strip_.height, tick, {}};
  for (const std::string& name : names_) {
    const std::vector<std::uint8_t>& rgb = task.views.find(name)->rgb;
    strip.rgb.insert(strip.rgb.end(), rgb.begin(), rgb.end());
  }
  const auto frozen = strip_.fault(expected_strip_, &strip, task.vehicle->state, tick);
  return frozen ? "cameras '" + core::joinText(names_, "', '") + "': " + *frozen : "";
}

std::vector<const std::uint8_t*> RigWatch::pixels(const planning::PlanningTask& task) const {
  std::vector<const std::uint8_t*> pixels;
  for (const std::string& name : names_) pixels.push_back(task.views.find(name)->rgb.data());
  return pixels;
}

}  // namespace cdiff::planners
