// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "reference_driver/careful_driver.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::reference_driver {
namespace {

constexpr double kSteadySpeed = 0.1;  // across the path of a vehicle that keeps its offset [m/s]
constexpr double kCenterLine = 0.7;   // from the corridor to the line beside the lane [m]
constexpr double kForgotten = 0.5;    // who was not seen for so long is new [s]
constexpr double kLeastSpeed = 1.0;   // at which it looks ahead, though it stands [m/s]

}  // namespace

void CarefulDriverOptions::describe(core::OptionsVisitor& visitor) {
  visitor.number({"evaluation_time", "s", "From first evidence to a perceived risk."},
                 evaluation_time, 0.0, 5.0);
  visitor.number({"delay", "s", "From a perceived risk until the brake acts."}, delay, 0.0, 10.0);
  visitor.number({"ramp_time", "s", "Until the brake acts fully."}, ramp_time, 0.05, 5.0);
  visitor.number({"deceleration", "m/s^2", "Full braking."}, deceleration, 0.1, 8.0);
  visitor.number({"lateral_deviation", "m", "Beyond it a vehicle that comes nearer cuts in."},
                 lateral_deviation, 0.0, 5.0);
  visitor.number({"lead_time", "s", "Time to collision with a lead that is a risk."}, lead_time,
                 0.1, 10.0);
  visitor.number({"lead_deceleration", "m/s^2", "Braking of a lead that is a risk."},
                 lead_deceleration, 0.1, 10.0);
  visitor.number({"look_ahead", "s", "For vehicles that come into its way."}, look_ahead, 0.1,
                 10.0);
  visitor.number({"arrival_gap", "s", "Missing another by less than this is a risk."}, arrival_gap,
                 0.0, 5.0);
  visitor.number({"yielding_deceleration", "m/s^2",
                  "Who can still stop before its way with this is expected to yield."},
                 yielding_deceleration, 0.1, 10.0);
  visitor.number({"horizon", "s", "Within which it must be able to stop."}, horizon, 0.1, 60.0);
}

void CarefulDriverOptions::validate(double top_speed, const std::string& group) const {
  const auto require = [&](bool right, const char* key, double value, const char* expected) {
    if (right) return;
    throw core::InputError("key '" + group + key + "' is " + core::formatNumber(value) +
                           "; expected " + expected);
  };
  require(delay >= 0.0, "delay", delay, "a time of at least 0 s");
  require(evaluation_time >= 0.0, "evaluation_time", evaluation_time, "a time of at least 0 s");
  require(ramp_time > 0.0, "ramp_time", ramp_time, "a time above 0 s");
  require(deceleration > 0.0, "deceleration", deceleration, "more than 0 m/s^2");
  const std::string longer = "at least the " + core::formatNumber(stoppingTime(top_speed)) +
                             " s in which it stops from " + core::formatNumber(top_speed) +
                             " m/s (keys evaluation_time, delay, ramp_time, deceleration)";
  require(stopsFrom(top_speed), "horizon", horizon, longer.c_str());
}

double CarefulDriverOptions::stoppingTime(double speed) const {
  return evaluation_time + delay + 0.5 * ramp_time + speed / deceleration;
}

double CarefulDriverOptions::stoppingDistance(double speed) const {
  return speed * (evaluation_time + delay + 0.5 * ramp_time) +
         speed * speed / (2.0 * deceleration) - deceleration * ramp_time * ramp_time / 24.0;
}

CarefulDriver::CarefulDriver(const CarefulDriverOptions& options) : options_(options) {
  options_.validate();
}

std::unique_ptr<ReferenceDriver> CarefulDriver::clone() const {
  return std::make_unique<CarefulDriver>(*this);
}

CarefulDriver::Clock& CarefulDriver::clockOf(const SeenVehicle& vehicle, const Conflict& conflict,
                                             double time) {
  auto known = std::find_if(clocks_.begin(), clocks_.end(),
                            [&](const Clock& clock) { return clock.id == vehicle.id; });
  if (known == clocks_.end())
    known = clocks_.insert(known, {vehicle.id, time, conflict.to_corridor, -1.0, true});
  Clock& clock = *known;
  if (time - clock.seen_time > kForgotten)
    clock = {vehicle.id, time, conflict.to_corridor, -1.0, true};
  const bool nears =
      vehicle.across_speed * vehicle.offset < 0.0 && std::abs(vehicle.across_speed) > kSteadySpeed;
  clock.steady_offset =
      nears ? std::max(clock.steady_offset, conflict.to_corridor) : conflict.to_corridor;
  clock.seen_time = time;
  clock.kept = true;
  return clock;
}

/// A pedestrian or a bicycle, by its box, is not expected to yield.
bool CarefulDriver::isSmall(const SeenVehicle& vehicle) {
  constexpr double kSmall = 1.0;  // half of the shortest car [m]
  return std::max(vehicle.half_along, vehicle.half_across) < kSmall;
}

bool CarefulDriver::isRisk(const OwnMotion& own, const Conflict& conflict,
                           const SeenVehicle& vehicle, const Clock& clock, bool nearest) const {
  const double look_ahead =
      clock.evidence_since < 0.0 ? options_.look_ahead : 2.0 * options_.look_ahead;
  if (conflict.kind == ConflictKind::kLead) {
    const bool began = clock.evidence_since >= 0.0;
    if (!nearest || !conflict.ahead) return began && conflict.ahead;
    const double closing = std::max(0.0, own.speed - vehicle.along_speed);
    const bool answers = -own.acceleration >= closing * closing / (2.0 * conflict.gap);
    if (!began && closing > 0.0 && answers) return false;
    const bool brakes = vehicle.acceleration < -options_.lead_deceleration;
    return brakes || meets(conflict, began ? look_ahead : options_.lead_time, 0.0);
  }
  if (!meets(conflict, look_ahead, options_.arrival_gap)) return false;
  if (conflict.kind == ConflictKind::kCutIn)
    return conflict.gap >= 0.0 &&
           clock.steady_offset - conflict.to_corridor > options_.lateral_deviation;
  if (conflict.kind == ConflictKind::kOncoming) return conflict.to_corridor < kCenterLine;
  if (isSmall(vehicle)) return true;
  const double yielding = std::max(options_.yielding_deceleration, -vehicle.acceleration);
  return conflict.stops_before > yielding;
}

bool CarefulDriver::isDue(const Clock& clock, double time) const {
  const double wait = options_.evaluation_time + options_.delay + extra_delay_;
  return clock.evidence_since >= 0.0 && time - clock.evidence_since >= wait - kTimeTolerance;
}

bool CarefulDriver::perceives() const {
  return std::any_of(clocks_.begin(), clocks_.end(), [&](const Clock& clock) {
    return clock.evidence_since >= 0.0 &&
           clock.seen_time - clock.evidence_since >= options_.evaluation_time - kTimeTolerance;
  });
}

double CarefulDriver::brake(const OwnMotion& own, const std::vector<SeenVehicle>& seen,
                            double duration) {
  for (Clock& clock : clocks_) clock.kept = false;
  const double speed = std::max(own.speed, kLeastSpeed);
  double nearest = std::numeric_limits<double>::infinity();
  for (const SeenVehicle& vehicle : seen) {
    const Conflict conflict = conflictOf(own, speed, vehicle);
    if (conflict.to_corridor < 0.0 && conflict.ahead) nearest = std::min(nearest, conflict.gap);
  }
  bool due = false;
  for (const SeenVehicle& vehicle : seen) {
    Conflict conflict = conflictOf(own, speed, vehicle);
    if (conflict.kind == ConflictKind::kLead) conflict = conflictOf(own, own.speed, vehicle);
    Clock& clock = clockOf(vehicle, conflict, own.time);
    const bool risk = isRisk(own, conflict, vehicle, clock, conflict.gap <= nearest);
    if (!risk) clock.evidence_since = -1.0;
    if (risk && clock.evidence_since < 0.0) clock.evidence_since = own.time;
    due = due || isDue(clock, own.time);
  }
  clocks_.erase(std::remove_if(clocks_.begin(), clocks_.end(),
                               [](const Clock& clock) { return !clock.kept; }),
                clocks_.end());
  if (due)
    return ramp_.press(options_.deceleration, options_.deceleration / options_.ramp_time, duration,
                       own);
  ramp_.release();
  return 0.0;
}

double followingGap(double speed) {
  constexpr double kLeast = 2.0;  // [m]
  constexpr double kSlow = 2.0, kFast = 60.0 / 3.6;
  const double share = std::clamp((speed - kSlow) / (kFast - kSlow), 0.0, 1.0);
  return std::max(kLeast, speed * (1.0 + 0.6 * share));
}

}  // namespace cdiff::reference_driver
