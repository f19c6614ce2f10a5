// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "metrics/formulas/driving_score.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "e2e_cdiff/core/angle.h"

namespace cdiff::metrics {

namespace {

/// One kind of infraction: how often, the factor of 2.0, the charge of 2.1.
struct Kind {
  std::size_t count;
  double factor;
  double charge;
};

std::array<Kind, 7> kindsOf(const Infractions& infractions) {
  return {Kind{infractions.pedestrian_collisions, 0.50, 1.0},
          Kind{infractions.vehicle_collisions, 0.60, 0.7},
          Kind{infractions.static_collisions, 0.65, 0.6},
          Kind{infractions.red_lights, 0.70, 0.4},
          Kind{infractions.stop_signs, 0.80, 0.25},
          Kind{infractions.scenario_timeouts, 0.70, 0.4},
          Kind{infractions.yields_failed, 0.70, 0.4}};
}

/// Missing part of the traffic's speed, 0 to 1, at each checkpoint.
std::vector<double> speedDeficits(const Infractions& infractions) {
  std::vector<double> deficits;
  for (const double percent : infractions.minimum_speed_percent) {
    deficits.push_back(std::clamp(1.0 - percent / 100.0, 0.0, 1.0));
  }
  return deficits;
}

double productOfFactors(const Infractions& infractions, bool minimum_speed) {
  double product = 1.0;
  for (const Kind& kind : kindsOf(infractions)) {
    product *= std::pow(kind.factor, static_cast<double>(kind.count));
  }
  if (!minimum_speed) return product;
  for (const double deficit : speedDeficits(infractions)) product *= 1.0 - 0.3 * deficit;
  return product;
}

double sumOfCharges(const Infractions& infractions, bool minimum_speed) {
  double sum = 0.0;
  for (const Kind& kind : kindsOf(infractions))
    sum += kind.charge * static_cast<double>(kind.count);
  if (!minimum_speed) return sum;
  for (const double deficit : speedDeficits(infractions)) sum += 0.4 * deficit;
  return sum;
}

}  // namespace

double infractionPenalty(const Infractions& infractions, const ScoreRules& rules) {
  const double inside = std::clamp(1.0 - infractions.outside_lanes_percent / 100.0, 0.0, 1.0);
  if (rules.charges) return inside / (1.0 + sumOfCharges(infractions, rules.speed_counts));
  return inside * productOfFactors(infractions, rules.speed_counts);
}

double drivingScore(double route_completion_percent, const Infractions& infractions,
                    const ScoreRules& rules) {
  return std::max(0.0, route_completion_percent * infractionPenalty(infractions, rules));
}

void CollisionCounter::observe(double time, const traffic::VehicleState& ego,
                               const std::string& partner) {
  ++contacts_;
  if (ego.speed < options_.collision_minimum_speed || repeats(time, ego, partner)) return;
  ++count_;
  last_ = {time, ego.position, partner};
}

bool CollisionCounter::repeats(double time, const traffic::VehicleState& ego,
                               const std::string& partner) const {
  if (!last_) return false;
  const bool same_partner =
      partner == last_->partner && time - last_->time < options_.collision_repeat_time;
  const double distance = (ego.position - last_->position).norm();
  return same_partner || distance < options_.collision_repeat_distance;
}

namespace {

/// Mean speed of the background vehicles; NaN without any.
double backgroundSpeed(const traffic::TrafficSnapshot& snapshot) {
  double sum = 0.0;
  std::size_t n = 0;
  for (const traffic::Vehicle& vehicle : snapshot.vehicles) {
    if (vehicle.role != traffic::VehicleRole::kBackground) continue;
    if (!std::isfinite(vehicle.state.speed)) continue;
    sum += vehicle.state.speed;
    ++n;
  }
  return sum / static_cast<double>(n);
}

}  // namespace

MinimumSpeed::MinimumSpeed(double length, std::size_t checkpoints)
    : length_(length), checkpoints_(checkpoints) {}

void MinimumSpeed::observe(double arc_length, double ego_speed,
                           const traffic::TrafficSnapshot& snapshot) {
  if (passed_ == checkpoints_) return;
  arc_length_ = arc_length;
  const double background = backgroundSpeed(snapshot);
  if (std::isfinite(background) && std::isfinite(ego_speed)) {
    open_.ego += ego_speed;
    open_.background += background;
  }
  const double stretch = length_ / static_cast<double>(checkpoints_);
  const auto reached = static_cast<std::size_t>(std::floor(arc_length / stretch));
  if (reached <= passed_) return;
  passed_ = std::min(reached, checkpoints_);
  if (open_.background > 0.0) percents_.push_back(100.0 * open_.ego / open_.background);
  open_ = {};
}

std::vector<double> MinimumSpeed::percents() const {
  constexpr double kRouteEnd = 0.95;  // share of the route; its last meters are not always driven
  std::vector<double> percents = percents_;
  const bool ended = passed_ + 1 == checkpoints_ && arc_length_ > kRouteEnd * length_;
  if (ended && open_.background > 0.0) percents.push_back(100.0 * open_.ego / open_.background);
  return percents;
}

bool isOutsideLanes(const map::RoadNetwork& network, const traffic::VehicleState& ego,
                    const InfractionOptions& options) {
  constexpr double kWidestHalf = 10.0;  // [m] no lane is broader to a side
  if (!ego.position.allFinite()) return false;
  const double radius = kWidestHalf + options.outside_lane_margin;
  const auto near = network.lanesNear(ego.position, ego.elevation, radius, ego.heading);
  const auto holds = [&](const map::LaneMatch& match) {
    const double half = 0.5 * network.lane(match.lane).width;
    return match.projection.distance <= half + options.outside_lane_margin;
  };
  if (std::none_of(near.begin(), near.end(), holds)) return true;
  if (network.lane(near.front().lane).internal) return false;
  const double angle = std::abs(near.front().heading_difference);
  return angle > core::degreesToRadians(options.wrong_lane_angle);
}

void OutsideLanes::observe(const traffic::VehicleState& ego, double advance) {
  ++ticks_;
  if (advance <= 0.0) return;
  advance_ += advance;
  if (isOutsideLanes(network_, ego, options_)) outside_ += advance;
}

namespace {

constexpr double kTail = 0.8;        // of half the length, behind the center (CARLA's criterion)
constexpr double kLaneRadius = 5.0;  // [m] around that point; more than it moves in a tick

bool hasStopSign(const map::LaneLink& link) { return link.hasStopSign(); }

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
    if (std::none_of(links.begin(), links.end(), hasStopSign)) continue;
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
  if (std::all_of(links.begin(), links.end(), hasStopSign)) {
    ++stop_signs_crossed_;
    if (stopped_on_ != lane) ++stop_signs_;
  }
  stopped_on_ = map::kNoLane;
}

}  // namespace cdiff::metrics
