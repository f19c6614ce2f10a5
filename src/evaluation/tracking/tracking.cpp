// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/tracking/tracking.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>

#include "planners/two_stage_pid/pdm_lite_tracker.h"

namespace cdiff::evaluation {
namespace {

constexpr double kHalfLane = 1.75;                     // [m]
constexpr double kEnd = 4.0;                           // before the stop [m]
constexpr geometry::SearchWindow kNearby{10.0, 10.0};  // [m]

/// Sums over decisions.
struct Sums {
  std::size_t decisions = 0;
  std::size_t off_road = 0;
  double tracks = 0.0;
  std::size_t unfinished = 0;
  double lateral = 0.0;  ///< of squares, as those below
  double steer_change = 0.0;
  double speed_error = 0.0;
  double largest_lateral = 0.0;

  TrackingMeasures measures() const {
    const double n = std::max<double>(1.0, static_cast<double>(decisions));
    return {decisions,
            std::sqrt(lateral / n),
            largest_lateral,
            100.0 * static_cast<double>(off_road) / n,
            std::sqrt(steer_change / n),
            std::sqrt(speed_error / n),
            100.0 * static_cast<double>(unfinished) / std::max<double>(1.0, tracks)};
  }
};

bool offRoad(const Track& track, const traffic::VehicleState& state, double arc_length) {
  const traffic::VehicleDimensions size;
  const geometry::OrientedBox box{state.position, state.heading, size.length, size.width};
  const auto corners = box.corners();
  return std::any_of(corners.begin(), corners.end(), [&](const Eigen::Vector2d& corner) {
    return track.line.projectNear(corner, arc_length, kNearby).distance > kHalfLane;
  });
}

void driveTrack(const Track& track, const Following& following, const dynamics::BicycleModel& model,
                const core::RandomStream& random, Sums& sums) {
  const double end = track.stop() - kEnd;
  const auto most = static_cast<std::uint32_t>(2.0 * track.duration() / traffic::kRolloutStep);
  traffic::VehicleState state = track.start;
  double arc_length = track.line.project(state.position).arc_length;
  double steer = 0.0;
  for (std::uint32_t decision = 0; decision < most && arc_length < end; ++decision) {
    const Eigen::MatrixX2d plan = planOn(track, state, arc_length, random, decision);
    const traffic::ControlAction action = following(state.speed, plan);
    state = model.step(state, action, traffic::kRolloutStep);
    const geometry::Projection foot = track.line.projectNear(state.position, arc_length, kNearby);
    arc_length = foot.arc_length;
    const double too_fast = state.speed - track.speedAt(arc_length);
    ++sums.decisions;
    sums.off_road += offRoad(track, state, arc_length);
    sums.lateral += foot.distance * foot.distance;
    sums.largest_lateral = std::max(sums.largest_lateral, foot.distance);
    sums.steer_change += (action.steer - steer) * (action.steer - steer);
    sums.speed_error += too_fast * too_fast;
    steer = action.steer;
  }
  sums.tracks += 1.0;
  sums.unfinished += arc_length < end;
}

/// Calls a tracker that it owns.
template <class Tracker>
Following followingOf(const Tracker& tracker) {
  const auto owned = std::make_shared<Tracker>(tracker);
  return [owned](double speed, const Eigen::MatrixX2d& plan) { return owned->track(speed, plan); };
}

}  // namespace

NamedTracker planTracker(const std::string& name, const planning::PlanTrackerOptions& options) {
  return {name, [options] { return followingOf(planning::PlanTracker(options)); }};
}

NamedTracker pdmLiteTracker() {
  return {
      planners::kPdmLiteTracker, [] {
        return followingOf(planners::PdmLiteTracker(planning::PlanTrackerOptions().speed_horizon));
      }};
}

double TrackingMeasures::cost() const {
  return lateral + 0.5 * off_road_percent + 0.5 * steer_change + 0.1 * speed_error +
         0.1 * unfinished_percent;
}

TrackingMeasures drive(const std::vector<Track>& tracks, const NamedTracker& tracker,
                       const dynamics::BicycleModel& model, const core::RandomStream& random) {
  Sums sums;
  for (const Track& track : tracks) driveTrack(track, tracker.make(), model, random, sums);
  return sums.measures();
}

std::vector<Track> ofKind(const std::vector<Track>& tracks, const std::string& kind) {
  std::vector<Track> found;
  std::copy_if(tracks.begin(), tracks.end(), std::back_inserter(found),
               [&](const Track& track) { return track.kind == kind; });
  return found;
}

}  // namespace cdiff::evaluation
