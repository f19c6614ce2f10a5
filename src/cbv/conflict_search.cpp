// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "cbv/conflict_search.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "cbv/candidate_gates.h"
#include "cbv/cbv_options.h"
#include "e2e_cdiff/core/angle.h"

namespace cdiff::cbv {
namespace {

constexpr double kClearlyBetter =
    1.0 + 1e-9;  // else the nearer point stays: rounding decides nothing
constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::vector<double> sampledArcLengths(double length, double spacing) {
  std::vector<double> arc_lengths;
  for (int i = 0; i * spacing < length - 1e-6; ++i) arc_lengths.push_back(i * spacing);
  arc_lengths.push_back(length);
  return arc_lengths;
}

/// Distance to drive to a place, given those to the starts of lanes; infinity when there is no
/// route.
double drivenDistance(const std::vector<double>& to_starts, const map::LanePosition& start,
                      const map::LanePosition& goal) {
  if (goal.lane == start.lane && goal.arc_length >= start.arc_length) {
    return goal.arc_length - start.arc_length;
  }
  const double distance = to_starts[static_cast<std::size_t>(goal.lane)] + goal.arc_length;
  return distance >= 0.0 ? distance : kInfinity;  // negative: beside the candidate and behind it
}

}  // namespace

double arrivalTime(double distance, double speed, double minimum_speed) {
  return distance / std::max(speed, minimum_speed);
}

double interactionScore(const ConflictPoint& point, double separation, const CbvOptions& options) {
  const double distance_ratio = (point.cbv_distance - point.ego_distance) / options.distance_sigma;
  const double time_ratio = point.arrivalTimeGap() / options.time_sigma;
  return std::exp(-0.5 * distance_ratio * distance_ratio - 0.5 * time_ratio * time_ratio -
                  separation / options.nearness_length);
}

ConflictSearch::ConflictSearch(const CbvOptions& options, const map::LaneGraph& graph,
                               const map::Route& ego_route)
    : options_(options), graph_(graph) {
  for (const double arc_length : sampledArcLengths(ego_route.length(), options.sample_spacing)) {
    Sample sample;
    sample.arc_length = arc_length;
    sample.position = ego_route.path().positionAt(arc_length);
    sample.place.lane = ego_route.laneAt(arc_length);
    const map::Lane& lane = graph.network().lane(sample.place.lane);
    sample.place.arc_length = lane.centerline.project(sample.position).arc_length;
    samples_.push_back(sample);
  }
}

std::vector<const ConflictSearch::Sample*> ConflictSearch::samplesInView(
    const traffic::VehicleState& candidate, double ego_arc_length) const {
  const Eigen::Vector2d preview = previewPoint(candidate, options_.preview_distance);
  const Eigen::Vector2d forward = geometry::direction(candidate.heading);
  const double least_cosine = std::cos(core::degreesToRadians(0.5 * options_.field_of_view));
  const auto ahead_of_ego = [](double arc_length, const Sample& sample) {
    return arc_length < sample.arc_length;
  };
  std::vector<const Sample*> seen;
  auto sample = std::upper_bound(samples_.begin(), samples_.end(), ego_arc_length, ahead_of_ego);
  for (; sample != samples_.end(); ++sample) {
    if (sample->arc_length > ego_arc_length + options_.ego_route_length) break;
    const Eigen::Vector2d offset = sample->position - preview;
    const double distance = offset.norm();
    if (distance > options_.interaction_radius) continue;
    if (forward.dot(offset) >= least_cosine * distance) seen.push_back(&*sample);
  }
  return seen;
}

ConflictPoint ConflictSearch::pointAt(const Sample& sample, double cbv_distance, double cbv_speed,
                                      const EgoProgress& ego) const {
  ConflictPoint point;
  point.position = {sample.position.x(), sample.position.y(), 0.0};
  point.position.z() =
      graph_.network().lane(sample.place.lane).centerline.pointAt(sample.place.arc_length).z();
  point.ego_arc_length = sample.arc_length;
  point.ego_distance = sample.arc_length - ego.arc_length;
  point.cbv_distance = cbv_distance;
  point.ego_arrival = arrivalTime(point.ego_distance, ego.state.speed, options_.minimum_speed);
  point.cbv_arrival = arrivalTime(cbv_distance, cbv_speed, options_.minimum_speed);
  return point;
}

ConflictResult ConflictSearch::find(const traffic::VehicleState& candidate,
                                    const map::LanePosition& place, const EgoProgress& ego) const {
  const std::vector<const Sample*> seen = samplesInView(candidate, ego.arc_length);
  if (seen.empty()) return {std::nullopt, kOutOfView};
  const double longest = seen.back()->arc_length - ego.arc_length + options_.route_distance_gate;
  const std::vector<double> to_starts = graph_.distancesFrom(place, longest);
  const double separation = (candidate.position - ego.state.position).norm();
  ConflictResult result{std::nullopt, kNoWay};
  for (const Sample* sample : seen) {
    const double distance = drivenDistance(to_starts, place, sample->place);
    if (distance > longest) continue;
    const ConflictPoint point = pointAt(*sample, distance, candidate.speed, ego);
    if (std::abs(point.cbv_distance - point.ego_distance) >= options_.route_distance_gate) {
      if (!result.conflict) result.reason = kDistanceMismatch;
      continue;
    }
    const double score = interactionScore(point, separation, options_);
    if (result.conflict && score <= result.conflict->score * kClearlyBetter) continue;
    result = {Conflict{point, sample->place, score}, nullptr};
  }
  return result;
}

}  // namespace cdiff::cbv
