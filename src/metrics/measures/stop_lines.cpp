// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "metrics/measures/stop_lines.h"

#include <algorithm>

namespace cdiff::metrics {
namespace {

constexpr double kTail = 0.8;        // of half the length, behind the center (CARLA's criterion)
constexpr double kLaneRadius = 5.0;  // [m] around that point; more than it moves in a tick

bool isStopSign(const map::LaneLink& link) { return link.state == 's' || link.state == 'w'; }

bool isRed(const map::LaneLink& link, const std::vector<traffic::SignalState>& signals) {
  for (const traffic::SignalState& signal : signals) {
    if (signal.id != link.signal_id) continue;
    const auto index = static_cast<std::size_t>(link.signal_link);
    if (link.signal_link < 0 || index >= signal.state.size()) return false;
    return signal.state[index] == 'r' || signal.state[index] == 'u';
  }
  return false;
}

bool hasLight(const map::LaneLink& link) { return !link.signal_id.empty(); }

}  // namespace

StopLines::StopLines(const map::RoadNetwork& network, const map::Route& route,
                     const InfractionOptions& options)
    : network_(network), options_(options) {
  const std::vector<map::LaneIndex>& lanes = route.lanes();
  for (std::size_t i = 1; i < lanes.size(); ++i) {
    if (lanes[i] != lanes[i - 1]) taken_.emplace_back(lanes[i - 1], lanes[i]);
  }
  std::sort(taken_.begin(), taken_.end());
}

void StopLines::observe(const traffic::Vehicle& ego,
                        const std::vector<traffic::SignalState>& signals) {
  const traffic::VehicleState& state = ego.state;
  const Eigen::Vector2d tail =
      state.position - kTail * 0.5 * ego.dimensions.length * geometry::direction(state.heading);
  if (!tail.allFinite()) return;
  std::vector<map::LaneIndex> lanes;
  for (const map::LaneMatch& match : network_.lanesNear(tail, state.elevation, kLaneRadius)) {
    if (!network_.lane(match.lane).internal) lanes.push_back(match.lane);
  }
  noteStop(ego, lanes);
  for (const map::LaneIndex lane : lanes) {
    if (!last_tail_ || !crosses(network_.lane(lane), tail)) continue;
    cross(lane, signals);
    break;  // on the border of two lanes it is still one line
  }
  last_tail_ = tail;
}

StopLines::Place StopLines::placeAt(const map::Lane& lane, const Eigen::Vector2d& point) const {
  const Eigen::Vector3d& end = lane.centerline.points().back();
  const double heading = lane.centerline.headingAt(lane.centerline.length());
  const Eigen::Vector2d body = geometry::Pose2d{end.head<2>(), heading}.toBody(point);
  return {body.x(), body.y()};
}

StopLines::Links StopLines::linksOf(map::LaneIndex lane) const {
  const Links& all = network_.lane(lane).next;
  Links taken;
  for (const map::LaneLink& link : all) {
    if (std::binary_search(taken_.begin(), taken_.end(), std::make_pair(lane, link.to)))
      taken.push_back(link);
  }
  return taken.empty() ? all : taken;
}

bool StopLines::crosses(const map::Lane& lane, const Eigen::Vector2d& tail) const {
  const Place before = placeAt(lane, *last_tail_);
  const Place now = placeAt(lane, tail);
  if (before.beyond >= 0.0 || now.beyond < 0.0) return false;
  const double share = -before.beyond / (now.beyond - before.beyond);
  const double beside = before.beside + share * (now.beside - before.beside);
  return std::abs(beside) <= 0.5 * lane.width;
}

void StopLines::noteStop(const traffic::Vehicle& ego, const std::vector<map::LaneIndex>& lanes) {
  if (ego.state.speed >= options_.stop_sign_speed) return;
  const Eigen::Vector2d front =
      ego.state.position + 0.5 * ego.dimensions.length * geometry::direction(ego.state.heading);
  for (const map::LaneIndex lane : lanes) {
    const Links links = linksOf(lane);
    if (std::none_of(links.begin(), links.end(), isStopSign)) continue;
    const Place place = placeAt(network_.lane(lane), front);
    const bool near = place.beyond >= -options_.stop_sign_distance;
    if (near && std::abs(place.beside) <= 0.5 * network_.lane(lane).width) stopped_on_ = lane;
  }
}

void StopLines::cross(map::LaneIndex lane, const std::vector<traffic::SignalState>& signals) {
  const Links links = linksOf(lane);
  if (links.empty()) return;
  if (std::all_of(links.begin(), links.end(), hasLight)) {
    ++lights_crossed_;
    const auto red = [&](const map::LaneLink& link) { return isRed(link, signals); };
    if (std::all_of(links.begin(), links.end(), red)) ++red_lights_;
  }
  if (std::all_of(links.begin(), links.end(), isStopSign)) {
    ++stop_signs_crossed_;
    if (stopped_on_ != lane) ++stop_signs_;
  }
  stopped_on_ = map::kNoLane;
}

}  // namespace cdiff::metrics
