// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "reference_driver/drive_ahead.h"

#include <algorithm>
#include <cmath>

namespace cdiff::reference_driver {
namespace {

const traffic::VehicleState& stateAt(const ForeseenVehicle& vehicle, std::size_t step) {
  return vehicle.states[std::min(step, vehicle.states.size() - 1)];
}

/// Whether the boxes are nearer to each other than the clearance (at their corners a little more).
bool touches(const geometry::OrientedBox& own, const ForeseenVehicle& other,
             const traffic::VehicleState& state, double clearance) {
  const geometry::OrientedBox grown{own.center, own.heading, own.length + 2.0 * clearance,
                                    own.width + 2.0 * clearance};
  const double reach =
      0.5 * (grown.length + grown.width + other.dimensions.length + other.dimensions.width);
  if ((grown.center - state.position).squaredNorm() > reach * reach) return false;
  return geometry::overlap(
      grown, {state.position, state.heading, other.dimensions.length, other.dimensions.width});
}

std::optional<std::size_t> touchedAt(const DrivenPath& path, const OwnMotion& own,
                                     const std::vector<ForeseenVehicle>& others, std::size_t step,
                                     double clearance) {
  const geometry::OrientedBox box = path.boxOf(own);
  for (std::size_t i = 0; i < others.size(); ++i) {
    if (touches(box, others[i], stateAt(others[i], step), clearance)) return i;
  }
  return std::nullopt;
}

}  // namespace

void advance(OwnMotion& own, double acceleration, double top_speed, double duration) {
  const double fastest = std::max(own.speed, top_speed);
  const double next = std::clamp(own.speed + acceleration * duration, 0.0, fastest);
  const bool stops = next <= 0.0 && acceleration < 0.0;
  own.arc_length +=
      stops ? own.speed * own.speed / (-2.0 * acceleration) : 0.5 * (own.speed + next) * duration;
  own.acceleration = (next - own.speed) / duration;
  own.speed = next;
  own.time += duration;
}

std::vector<SeenVehicle> seeAt(const DrivenPath& path, const std::vector<ForeseenVehicle>& others,
                               std::size_t step, std::vector<std::optional<std::size_t>>& hints) {
  std::vector<SeenVehicle> seen;
  seen.reserve(others.size());
  for (std::size_t i = 0; i < others.size(); ++i) {
    const traffic::VehicleState& now = stateAt(others[i], step);
    auto vehicle = path.see(now, others[i].dimensions, hints[i]);
    if (!vehicle) continue;
    vehicle->id = others[i].id;
    const double before = stateAt(others[i], step > 0 ? step - 1 : 0).speed;
    vehicle->acceleration = (now.speed - before) / kForeseenStep;
    seen.push_back(*vehicle);
  }
  return seen;
}

DriveOutcome driveAhead(ReferenceDriver& driver, const OwnMotion& start, const DrivenPath& path,
                        const std::vector<ForeseenVehicle>& others, const DriveTerms& terms) {
  constexpr double kHeld = 1.0;  // of a positive acceleration [s]
  DriveOutcome outcome;
  OwnMotion own = start;
  const double held = std::max(0.0, start.acceleration);
  std::vector<std::optional<std::size_t>> hints(others.size());
  const auto steps = static_cast<std::size_t>(std::lround(terms.duration / kForeseenStep));
  for (std::size_t step = 0; step < steps; ++step) {
    const double time = static_cast<double>(step) * kForeseenStep;
    const double braking = driver.brake(own, seeAt(path, others, step, hints), kForeseenStep);
    if (braking > 0.0 && !outcome.brake_time) outcome.brake_time = time;
    const bool accelerates = !outcome.brake_time && time < kHeld;
    advance(own,
            braking > 0.0 ? -braking
            : accelerates ? held
                          : 0.0,
            terms.top_speed, kForeseenStep);
    const auto struck = touchedAt(path, own, others, step + 1, terms.clearance);
    if (!struck) continue;
    outcome.contact_time = time + kForeseenStep;
    outcome.struck = *struck;
    break;
  }
  outcome.at_contact = own;
  return outcome;
}

}  // namespace cdiff::reference_driver
