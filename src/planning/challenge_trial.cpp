// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planning/challenge_trial.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "e2e_cdiff/core/random.h"
#include "planning/surrounding_vehicles.h"

namespace cdiff::planning {
namespace {

using reference_driver::CarefulDriver;
using reference_driver::DriveOutcome;
using reference_driver::ForeseenVehicle;
using reference_driver::kForeseenStep;
using reference_driver::OwnMotion;

constexpr double kClearance = 0.3;       // that C keeps [m]
constexpr double kPlanTime = 3.2;        // [s]
constexpr double kApproachTime = 8.0;    // within which an approach leads to a hit [s]
constexpr double kBeyond = 1.0;          // that is looked at after it and after standstill [s]
constexpr double kHardBraking = 8.0;     // of a CBV after its plan [m/s^2]
constexpr double kCrawlingSpeed = 1.0;   // of a CBV that no longer attacks [m/s]
constexpr double kRearAxle = 1.4178275;  // behind the ego's center [m]
constexpr double kMostDelay = 1.0;       // of delta [s]
constexpr int kBisections = 4;           // of delta: to 1/16 s
constexpr double kMostGain = 2.0;        // of the ego's speed before C brakes [m/s]

/// The ego as it does, not as it should: its braking goes on.
class HeldBraking final : public reference_driver::ReferenceDriver {
 public:
  explicit HeldBraking(double acceleration) : braking_(-acceleration) {}
  double brake(const OwnMotion&, const std::vector<reference_driver::SeenVehicle>&,
               double) override {
    constexpr double kFelt = 0.5;  // [m/s^2]
    return braking_ > kFelt ? braking_ : 0.0;
  }
  std::unique_ptr<ReferenceDriver> clone() const override {
    return std::make_unique<HeldBraking>(*this);
  }

 private:
  double braking_;
};

std::vector<traffic::VehicleState> straightOn(traffic::VehicleState state, double braking,
                                              std::size_t steps) {
  std::vector<traffic::VehicleState> states;
  for (std::size_t i = 0; i < steps; ++i) {
    const double next = std::max(0.0, state.speed - braking * kForeseenStep);
    state.position +=
        0.5 * (state.speed + next) * kForeseenStep * geometry::direction(state.heading);
    state.speed = next;
    states.push_back(state);
  }
  return states;
}

/// Along the nearest lane of its direction, at its speed.
std::vector<traffic::VehicleState> alongLane(const traffic::Vehicle& cbv,
                                             const traffic::VehicleState& end,
                                             const map::RoadNetwork& network, std::size_t steps) {
  constexpr double kRadius = 3.0;     // [m]
  constexpr double kMostAngle = 1.0;  // [rad]
  traffic::Vehicle vehicle = cbv;
  vehicle.state = end;
  vehicle.acceleration = vehicle.yaw_rate = 0.0;
  vehicle.applied_action.reset();
  vehicle.lane_id.clear();
  for (const map::LaneMatch& match :
       network.lanesNear(end.position, end.elevation, kRadius, end.heading)) {
    if (std::abs(match.heading_difference) > kMostAngle) continue;
    vehicle.lane_id = network.lane(match.lane).id;
    break;
  }
  return forecastMotion(vehicle, network, {}, steps);
}

/// From the end of a plan, which may be longer, to a time from now [s].
std::size_t stepsAfter(const ForeseenVehicle& planned, double time) {
  const double rest = time - kForeseenStep * static_cast<double>(planned.states.size() - 1);
  return static_cast<std::size_t>(std::max(0.0, std::ceil(rest / kForeseenStep)));
}

/// Whether the middle of what the boxes share along the ego lies behind its rear axle.
bool isBehind(const geometry::OrientedBox& ego, const geometry::OrientedBox& cbv) {
  const geometry::Pose2d frame{ego.center, ego.heading};
  double first = std::numeric_limits<double>::infinity();
  double last = -first;
  for (const Eigen::Vector2d& corner : cbv.corners()) {
    const double x = frame.toBody(corner).x();
    first = std::min(first, x);
    last = std::max(last, x);
  }
  const double half = 0.5 * ego.length;
  return 0.5 * (std::max(first, -half) + std::min(last, half)) < -kRearAxle;
}

}  // namespace

double ChallengeCourse::duration() const {
  const reference_driver::CarefulDriverOptions careful;
  return std::max(kPlanTime, careful.stoppingTime(own_.speed)) + kBeyond;
}

/// How a driver is touched within the plan: "hit" or what speaks against it; empty: not at all.
std::string ChallengeCourse::strikeOf(reference_driver::ReferenceDriver& driver,
                                      ChallengeTrial& trial, double duration) const {
  OwnMotion start = own_;
  start.acceleration = 0.0;
  const ForeseenVehicle& motion = trial.motions.front();
  const DriveOutcome outcome =
      driveAhead(driver, start, path_, {motion}, {duration, 0.0, own_.speed});
  if (!outcome.contact_time) return "";
  const auto step = static_cast<std::size_t>(std::lround(*outcome.contact_time / kForeseenStep));
  const traffic::VehicleState& there = motion.states[std::min(step, motion.states.size() - 1)];
  if (outcome.at_contact.speed <= kStandingEgo) return "the ego stands";
  if (isBehind(path_.boxOf(outcome.at_contact),
               {there.position, there.heading, motion.dimensions.length, motion.dimensions.width}))
    return "from behind";
  if (there.speed < kCrawlingSpeed) return "the CBV stands";
  trial.hit_time = outcome.contact_time;
  return "hit";
}

/// Fills `approach_time`.
void ChallengeCourse::findApproach(const traffic::Vehicle& cbv, ChallengeTrial& trial) const {
  const ForeseenVehicle& planned = trial.motions.front();
  const traffic::VehicleState& end = planned.states.back();
  if (own_.speed <= kStandingEgo || end.speed < kCrawlingSpeed) return;
  ForeseenVehicle motion = planned;
  const std::size_t steps = stepsAfter(planned, kApproachTime);
  const auto tail = alongLane(cbv, end, context_.network, steps);
  motion.states.insert(motion.states.end(), tail.begin(), tail.end());
  ChallengeTrial later;
  later.motions.front() = std::move(motion);
  reference_driver::UnresponsiveDriver unresponsive;
  if (strikeOf(unresponsive, later, kApproachTime) == "hit") trial.approach_time = later.hit_time;
}

/// Three ways to go on after the plan.
void ChallengeCourse::addTails(const traffic::Vehicle& cbv, ChallengeTrial& trial) const {
  const std::size_t steps = stepsAfter(trial.motions.front(), duration());
  const traffic::VehicleState end = trial.motions.front().states.back();
  const std::array<std::vector<traffic::VehicleState>, 3> tails{
      alongLane(cbv, end, context_.network, steps), straightOn(end, kHardBraking, steps),
      straightOn(end, 0.0, steps)};
  trial.motions.fill(trial.motions.front());
  for (std::size_t i = 0; i < tails.size(); ++i) {
    auto& states = trial.motions[i].states;
    states.insert(states.end(), tails[i].begin(), tails[i].end());
  }
}

ChallengeTrial ChallengeCourse::examine(const traffic::Vehicle& cbv,
                                        const ChallengePlan& plan) const {
  ChallengeTrial trial;
  ForeseenVehicle& foreseen = trial.motions.front();
  foreseen = {core::hashText(cbv.id), cbv.dimensions, {cbv.state}};
  foreseen.states.insert(foreseen.states.end(), plan.states.begin(), plan.states.end());
  HeldBraking as_it_does(own_.acceleration);
  reference_driver::UnresponsiveDriver unresponsive;
  const std::string braking = strikeOf(as_it_does, trial, kPlanTime);
  trial.hit_time.reset();
  const std::string steady = strikeOf(unresponsive, trial, kPlanTime);
  for (const std::string& strike : {braking, steady}) {
    if (strike == "from behind" || strike == "the ego stands") trial.refusal = strike;
  }
  if (trial.refusal.empty() && !trial.hit_time) findApproach(cbv, trial);
  if (trial.refusal.empty() && plan.only_to_hit && !trial.hit_time && !trial.approach_time)
    trial.refusal = "it does not hit";
  if (!plan.only_to_hit || trial.refusal.empty()) addTails(cbv, trial);
  return trial;
}

void ChallengeCourse::findRoad(ChallengeTrial& trial, std::size_t states) const {
  const ForeseenVehicle& motion = trial.motions.front();
  for (std::size_t i = 1; i <= states && i < motion.states.size(); ++i) {
    const traffic::VehicleState& state = motion.states[i];
    const geometry::OrientedBox box{state.position, state.heading, motion.dimensions.length,
                                    motion.dimensions.width};
    if (context_.drivable_area.signedDistance(box, state.elevation) < 0.0) ++trial.off_road;
  }
}

bool ChallengeCourse::answers(const CarefulDriver& driver, const OwnMotion& start,
                              ChallengeTrial& trial, double extra_delay) const {
  bool all = true;
  for (const ForeseenVehicle& motion : trial.motions) {
    CarefulDriver careful = driver;
    careful.delayBy(extra_delay);
    std::vector<ForeseenVehicle> vehicles{motion};
    for (const ForeseenVehicle& other : chosen_) vehicles.push_back(other);
    const DriveOutcome outcome = driveAhead(careful, start, path_, vehicles,
                                            {duration(), kClearance, start.speed + kMostGain});
    if (extra_delay == 0.0 && outcome.brake_time)
      trial.brake_time =
          std::min(trial.brake_time.value_or(*outcome.brake_time), *outcome.brake_time);
    if (!outcome.contact_time) continue;
    all = false;
    if (extra_delay > 0.0) break;
    trial.margin = std::min(trial.margin, *outcome.contact_time);
  }
  return all;
}

void ChallengeCourse::findDelta(ChallengeTrial& trial) const {
  double low = answers(driver_, own_, trial, kMostDelay) ? kMostDelay : 0.0;
  double high = kMostDelay;
  for (int i = 0; i < kBisections && low < high; ++i) {
    const double middle = 0.5 * (low + high);
    (answers(driver_, own_, trial, middle) ? low : high) = middle;
  }
  trial.delta = low;
}

}  // namespace cdiff::planning
