// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "cbv/candidates.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/option_fields.h"
#include "core/text.h"
#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::cbv {
namespace {

void describeGates(CbvOptions& options, core::OptionsVisitor& visitor) {
  visitor.number({"search_radius", "m", "Farthest candidate from the ego, center to center."},
                 options.search_radius, 1.0, 1000.0);
  visitor.number({"minimum_distance", "m", "Nearest candidate to the ego, center to center."},
                 options.minimum_distance, 0.0, 1000.0);
  visitor.number({"interaction_radius", "m",
                  "Straight distance from a candidate to a point of the ego's route."},
                 options.interaction_radius, 1.0, 1000.0);
  visitor.number(
      {"field_of_view", "deg", "Full angle ahead of a candidate in which that point must lie."},
      options.field_of_view, 1.0, 360.0);
  visitor.number({"route_distance_gate", "m",
                  "Difference of the distances to drive that a conflict stays below."},
                 options.route_distance_gate, 0.1, 1000.0);
  visitor.number(
      {"preview_distance", "m", "Point ahead of a candidate's center that must lie on a lane."},
      options.preview_distance, 0.0, 20.0);
  visitor.number({"junction_heading_gate", "deg",
                  "Largest angle between candidate and lane inside a junction."},
                 options.junction_heading_gate, 0.0, 180.0);
}

void describeScore(CbvOptions& options, core::OptionsVisitor& visitor) {
  visitor.number(
      {"distance_sigma", "m", "Width of the score in the difference of distances to drive."},
      options.distance_sigma, 0.1, 1000.0);
  visitor.number({"time_sigma", "s", "Width of the score in the difference of arrival times."},
                 options.time_sigma, 0.01, 1000.0);
  visitor.number(
      {"nearness_length", "m", "Decay length of the score with the distance to the ego."},
      options.nearness_length, 0.1, 10000.0);
  visitor.number({"minimum_speed", "m/s", "Least speed that arrival times are computed with."},
                 options.minimum_speed, 0.1, 50.0);
}

void describeRoutes(CbvOptions& options, core::OptionsVisitor& visitor) {
  visitor.number({"ego_route_length", "m", "Part of the ego's remaining route that is examined."},
                 options.ego_route_length, 1.0, 5000.0);
  visitor.number({"sample_spacing", "m", "Distance between examined points of the ego's route."},
                 options.sample_spacing, 0.5, 100.0);
  visitor.number(
      {"route_length", "m", "Least length of a conflict-aware route where the network allows it."},
      options.route_length, 1.0, 5000.0);
}

void describeTimes(CbvOptions& options, core::OptionsVisitor& visitor) {
  visitor.number({"first_time", "s", "No selection before this time."}, options.first_time, 0.0,
                 1e6);
  visitor.number({"period", "s", "Time between selections."}, options.period, 0.01, 1000.0);
  visitor.text(
      {"life_cycle", "",
       "rift: a CBV stays one; reselect: released on a lost conflict or for a better one."},
      options.life_cycle, {"rift", "reselect"});
  visitor.number({"hysteresis", "", "Reselect: by how much a challenger's score must be better."},
                 options.hysteresis, 0.0, 1.0);
  visitor.number(
      {"lost_conflict_time", "s", "Reselect: released after this long without a conflict."},
      options.lost_conflict_time, 0.0, 1000.0);
}

constexpr double kSearchRadius = 5.0;       // [m] at least half the width of any lane
constexpr double kHeadingAgreement = 60.0;  // [deg] of a vehicle with its own lane
constexpr double kLeastRemaining = 0.5;     // [m] of its lane: a route may start with a lane change
constexpr double kMetersPerRadian = 2.0;    // among overlapping lanes: heading against distance

bool liesOn(const map::RoadNetwork& network, const map::LaneMatch& match) {
  return match.projection.distance <= 0.5 * network.lane(match.lane).width;
}

/// kOffLane, kJunctionHeading or nullptr for the lanes near the preview point.
const char* failedPreview(const map::RoadNetwork& network, const std::vector<map::LaneMatch>& near,
                          double junction_heading_gate) {
  const char* reason = kOffLane;
  for (const map::LaneMatch& match : near) {
    if (!liesOn(network, match)) continue;
    const double difference = core::radiansToDegrees(std::abs(match.heading_difference));
    if (!network.lane(match.lane).internal || difference <= junction_heading_gate) return nullptr;
    reason = kJunctionHeading;
  }
  return reason;
}

std::optional<map::LanePosition> ownLane(const map::RoadNetwork& network,
                                         const traffic::Vehicle& vehicle) {
  const auto& state = vehicle.state;
  std::optional<map::LanePosition> best;
  double best_cost = std::numeric_limits<double>::infinity();
  for (const map::LaneMatch& match :
       network.lanesNear(state.position, state.elevation, kSearchRadius, state.heading)) {
    const double difference = std::abs(match.heading_difference);
    if (core::radiansToDegrees(difference) >= kHeadingAgreement) continue;
    const map::Lane& lane = network.lane(match.lane);
    const double last = std::max(0.0, lane.centerline.length() - kLeastRemaining);
    const map::LanePosition place{match.lane, std::min(match.projection.arc_length, last)};
    if (lane.id == vehicle.lane_id && liesOn(network, match)) return place;
    const double cost = match.projection.distance + kMetersPerRadian * difference;
    if (cost >= best_cost) continue;
    best_cost = cost;
    best = place;
  }
  return best;
}

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

void CbvOptions::describe(core::OptionsVisitor& visitor) {
  visitor.text({"ranking", "",
                "Order in which candidates fill the slots: by score, nearest to the ego first, or "
                "whoever passes the gates, by id."},
               ranking, {"score", "nearest", "gates"});
  describeGates(*this, visitor);
  describeRoutes(*this, visitor);
  describeScore(*this, visitor);
  describeTimes(*this, visitor);
}

void CbvOptions::validate() const {
  core::requireRanges(*this, "CBV");
  if (minimum_distance >= search_radius) {
    throw core::InputError(
        "CBV option 'minimum_distance' is " + core::formatNumber(minimum_distance) +
        "; expected less than 'search_radius', " + core::formatNumber(search_radius));
  }
}

const char* failedNearness(const traffic::Vehicle& vehicle, const traffic::Vehicle& ego,
                           const CbvOptions& options) {
  const double distance = (vehicle.state.position - ego.state.position).norm();
  if (distance > options.search_radius) return kTooFar;
  if (distance < options.minimum_distance) return kTooNear;
  return traffic::onDifferentLevels(vehicle, ego) ? kOtherLevel : nullptr;
}

LanePlacement placeOnLane(const map::RoadNetwork& network, const traffic::Vehicle& vehicle,
                          const CbvOptions& options) {
  const auto& state = vehicle.state;
  const Eigen::Vector2d preview = previewPoint(state, options.preview_distance);
  const char* failed = failedPreview(
      network, network.lanesNear(preview, state.elevation, kSearchRadius, state.heading),
      options.junction_heading_gate);
  if (failed != nullptr) return {failed, {}};
  const std::optional<map::LanePosition> place = ownLane(network, vehicle);
  if (!place) return {kOffLane, {}};
  return {nullptr, *place};
}

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
