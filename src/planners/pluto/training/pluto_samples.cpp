// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/pluto/training/pluto_samples.h"

#include <algorithm>
#include <cmath>

#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/core/random.h"
#include "learning/samples/sample_order.h"

namespace cdiff::planners {
namespace {

constexpr std::size_t kFutureSteps = static_cast<std::size_t>(kPlutoSteps);
constexpr std::size_t kFreeOfNoise = 10;  // decisions
constexpr std::size_t kLongNoise = 10;    // decisions

/// Whether the noise at a decision lasts longer than 1 s from there on.
bool stopIsForced(const PlutoDrive& drive, std::size_t decision) {
  for (std::size_t i = 0; i <= kLongNoise; ++i) {
    if (drive.disturbed.count(decision + i) == 0) return false;
  }
  return true;
}

/// How many decisions of the future count.
std::size_t stepsOf(const PlutoScene& scene, const PlutoDrive& drive, std::size_t begin) {
  const TrackPoint* before = scene.frames()[begin].find(drive.vehicle);
  for (std::size_t step = 0; step <= kFutureSteps; ++step) {
    const std::size_t i = begin + step;
    if (step < kFreeOfNoise && drive.disturbed.count(i) != 0) return 0;
    if (step == 0) continue;
    const bool there = i < scene.frames().size() && drive.places.count(i) != 0;
    const TrackPoint* after = there ? scene.frames()[i].find(drive.vehicle) : nullptr;
    if (after == nullptr || before == nullptr || !learning::drivesOn(before->state, after->state) ||
        scene.touches(drive.vehicle, i, i))
      return step - 1;
    if (stopIsForced(drive, i)) return step;
    before = after;
  }
  return kFutureSteps;
}

bool standsFor(const PlutoScene& scene, const PlutoDrive& drive, std::size_t begin,
               std::size_t steps) {
  for (std::size_t i = begin; i <= begin + steps; ++i) {
    if (scene.frames()[i].find(drive.vehicle)->state.speed > learning::kStanding) return false;
  }
  return true;
}

/// How a frame is led back to the way that was recorded (map frame, m): offsets to the left of it
/// and along it, over the distance driven.
class WayBack {
 public:
  WayBack(const traffic::VehicleState& recorded, const geometry::Pose2d& frame)
      : length_(std::clamp(kRecoveryTime * recorded.speed, kLeastRecovery, kLongestRecovery)) {
    const Eigen::Vector2d place = recorded.pose().toBody(frame.position);
    along_ = place.x();
    across_ = place.y();
    slope_ = std::tan(
        std::clamp(core::angleDifference(frame.heading, recorded.heading), -kMostTurn, kMostTurn));
  }

  /// Where it then is in place of a recorded state, `driven` behind the first one.
  traffic::VehicleState at(const traffic::VehicleState& recorded, double driven) const {
    const double share = driven / length_;
    if (share >= 1.0) return recorded;
    const double rest = 1.0 - share;
    const double fade = rest * rest * (1.0 + 2.0 * share);
    const double offset = across_ * fade + slope_ * driven * rest * rest;
    const double slope =
        -6.0 * across_ * share * rest / length_ + slope_ * rest * (rest - 2.0 * share);
    traffic::VehicleState state = recorded;
    state.position = recorded.pose().toMap({along_ * fade, offset});
    state.heading = recorded.heading + std::atan(slope);
    return state;
  }

 private:
  static constexpr double kRecoveryTime = 2.0;      // [s]
  static constexpr double kLeastRecovery = 10.0;    // [m]
  static constexpr double kLongestRecovery = 20.0;  // [m]
  static constexpr double kMostTurn = 1.2;          // [rad]
  double length_;
  double along_ = 0.0;
  double across_ = 0.0;
  double slope_ = 0.0;
};

Eigen::Matrix<float, 1, kPlutoChannels> rowOf(const geometry::Pose2d& frame,
                                              const traffic::VehicleState& state) {
  const Eigen::Vector2d place = frame.toBody(state.position);
  const double heading = state.heading - frame.heading;
  const Eigen::Vector2d velocity = state.speed * geometry::direction(heading);
  Eigen::Matrix<double, 1, kPlutoChannels> row;
  row << place.x(), place.y(), std::cos(heading), std::sin(heading), velocity.x(), velocity.y();
  return row.cast<float>();
}

}  // namespace

void PlutoSampleOptions::describe(core::OptionsVisitor& visitor) {
  SceneSampleOptions::describe(visitor);
  visitor.number({"least_future", "s", "Least time of undisturbed driving behind a sample."},
                 least_future, 1.0, 8.0);
}

namespace {

/// The line and the mode of a target, given its last known state. What is missing of a cut future
/// is driven along the line; lines that part only later are as near then, so the first of them, the
/// route, is taken.
void choosePlace(const std::vector<ReferenceLine>& lines, const traffic::VehicleState& last,
                 PlutoTarget& target) {
  constexpr double kAsNear = 0.5;  // [m]
  const double missing = kPlutoPeriod * static_cast<double>(kPlutoSteps - target.steps);
  const double least_gain = missing > 0.0 ? kAsNear : 0.0;
  double nearest = 0.0;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const LinePlace found = placeOn(lines[i], last.position);
    if (i > 0 && found.distance + least_gain >= nearest) continue;
    nearest = found.distance;
    target.line = i;
    const double end = found.arc_length + missing * last.speed;
    target.mode = std::min(static_cast<std::size_t>(kPlutoModes) - 1,
                           static_cast<std::size_t>(end / kModeLength));
  }
}

}  // namespace

std::vector<PlutoPlace> plutoPlaces(const PlutoScene& scene, std::uint32_t number,
                                    const PlutoSampleOptions& options) {
  const auto least = static_cast<std::size_t>(std::lround(options.least_future / kPlutoPeriod));
  const core::RandomStream thinning(core::hashText(scene.name()), "pluto_standing");
  std::vector<PlutoPlace> places;
  for (std::size_t d = 0; d < scene.drives().size(); ++d) {
    const PlutoDrive& drive = scene.drives()[d];
    if (!options.wants(drive.target_speed)) continue;
    for (const auto& [decision, arc_length] : drive.places) {
      if ((decision + d) % options.stride() != 0) continue;
      const std::size_t steps = stepsOf(scene, drive, decision);
      if (steps < least) continue;
      const core::RandomKey key{d, static_cast<std::uint32_t>(decision), 0};
      if (standsFor(scene, drive, decision, steps) &&
          thinning.uniform(key, 0) >= options.standing_share)
        continue;
      places.push_back({number, static_cast<std::uint32_t>(decision), static_cast<std::uint32_t>(d),
                        static_cast<std::uint32_t>(steps)});
    }
  }
  return places;
}

PlutoTarget plutoTarget(const PlutoScene& scene, const PlutoPlace& place,
                        const geometry::Pose2d& frame, const std::vector<ReferenceLine>& lines) {
  const std::uint32_t vehicle = scene.drives()[place.drive].vehicle;
  PlutoTarget target;
  target.steps = place.steps;
  traffic::VehicleState last = scene.frames()[place.decision].find(vehicle)->state;
  const WayBack way(last, frame);
  double driven = 0.0;
  for (std::int64_t step = 0; step < target.steps; ++step) {
    const std::size_t i = place.decision + 1 + static_cast<std::size_t>(step);
    const traffic::VehicleState& next = scene.frames()[i].find(vehicle)->state;
    driven += (next.position - last.position).norm();
    last = next;
    target.future.row(step) = rowOf(frame, way.at(last, driven));
    target.elevations[static_cast<std::size_t>(step)] = last.elevation;
  }
  choosePlace(lines, last, target);
  return target;
}

AgentFuture agentFuture(const PlutoScene& scene, std::size_t decision, std::uint32_t vehicle) {
  AgentFuture result;
  const geometry::Pose2d frame = scene.frames()[decision].find(vehicle)->state.pose();
  for (std::size_t step = 0; step < kFutureSteps; ++step) {
    const std::size_t i = decision + 1 + step;
    const TrackPoint* point = i < scene.frames().size() ? scene.frames()[i].find(vehicle) : nullptr;
    if (point == nullptr) break;
    result.future.row(static_cast<Eigen::Index>(step)) = rowOf(frame, point->state);
    result.known[step] = true;
  }
  return result;
}

learning::SampleSchema plutoFields() {
  using learning::FieldType;
  return {{{learning::kSessionField, FieldType::kU64},
           {"moment", FieldType::kU64, {4}},
           {"place", FieldType::kF64, {2}}}};
}

learning::Sample toSample(const PlutoPlace& place, const PlutoScene& scene) {
  const TrackPoint* point =
      scene.frames()[place.decision].find(scene.drives()[place.drive].vehicle);
  return {{{learning::kSessionField, std::vector<std::uint64_t>{core::hashText(scene.name())}},
           {"moment",
            std::vector<std::uint64_t>{place.scene, place.decision, place.drive, place.steps}},
           {"place", std::vector<double>{point->state.position.x(), point->state.position.y()}}}};
}

PlutoPlace toPlutoPlace(const learning::Sample& sample) {
  const auto& numbers = sample.get<std::vector<std::uint64_t>>("moment");
  return {static_cast<std::uint32_t>(numbers.at(0)), static_cast<std::uint32_t>(numbers.at(1)),
          static_cast<std::uint32_t>(numbers.at(2)), static_cast<std::uint32_t>(numbers.at(3))};
}

}  // namespace cdiff::planners
