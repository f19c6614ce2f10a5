// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/pluto/training/pluto_examples.h"

#include <algorithm>
#include <cmath>

#include "e2e_cdiff/core/angle.h"
#include "planning/route_follower.h"

namespace cdiff::planners {
namespace {

constexpr std::size_t kLookAhead = 40;  // decisions in which vehicles interact
constexpr double kShift = 5.0;          // along the route that a disturbance may lead to [m]

// Elements of the draws of a sample.
constexpr std::uint32_t kNoiseDraw = 0;  // and the five that follow
constexpr std::uint32_t kDropsDraw = 6;
constexpr std::uint32_t kDropShareDraw = 7;
constexpr std::uint32_t kNegativeDraw = 8;
constexpr std::uint32_t kGapDraw = 9;
constexpr std::uint32_t kSlowDraw = 10;
constexpr std::uint32_t kDropDraw = 16;  // and those that follow, by vehicle

geometry::OrientedBox boxOf(const traffic::VehicleState& state,
                            const traffic::VehicleDimensions& size) {
  return {state.position, state.heading, size.length, size.width};
}

/// States of a vehicle from a decision on, while it is there.
std::vector<traffic::VehicleState> statesAhead(const PlutoScene& scene, std::size_t decision,
                                               std::uint32_t vehicle) {
  std::vector<traffic::VehicleState> states;
  for (std::size_t i = decision; i <= decision + kLookAhead && i < scene.frames().size(); ++i) {
    const TrackPoint* point = scene.frames()[i].find(vehicle);
    if (point == nullptr) break;
    states.push_back(point->state);
  }
  return states;
}

bool meet(const std::vector<traffic::VehicleState>& first,
          const traffic::VehicleDimensions& first_size,
          const std::vector<traffic::VehicleState>& second,
          const traffic::VehicleDimensions& second_size) {
  const double gate = 4.0 + 0.5 * std::max(0.0, second_size.length - 5.0);  // [m] of the centers
  for (const traffic::VehicleState& a : first) {
    for (const traffic::VehicleState& b : second) {
      if ((a.position - b.position).norm() < gate &&
          geometry::overlap(boxOf(a, first_size), boxOf(b, second_size)))
        return true;
    }
  }
  return false;
}

/// Whether a place is free of the boxes of others.
bool isFree(const PlutoMoment& moment, const traffic::VehicleState& state) {
  const geometry::OrientedBox own = boxOf(state, moment.vehicles->size(moment.own));
  for (const TrackPoint& point : moment.frames.back()->points) {
    if (point.vehicle == moment.own ||
        traffic::onDifferentLevels(point.state.elevation, state.elevation))
      continue;
    if (geometry::overlap(own, boxOf(point.state, moment.vehicles->size(point.vehicle))))
      return false;
  }
  return true;
}

/// A red light that the vehicle stands before: its place in the list of lights and its link.
std::optional<std::pair<std::size_t, std::size_t>> redLight(const PlutoMoment& moment) {
  constexpr double kNearLine = 15.0;  // [m]
  constexpr double kWaiting = 0.5;    // [m/s]
  if (moment.point().state.speed > kWaiting) return std::nullopt;
  for (const map::Route::Signal& line : moment.route->signals()) {
    const double ahead = line.arc_length - moment.arc_length;
    if (ahead < 0.0 || ahead > kNearLine || line.link < 0) continue;
    for (std::size_t i = 0; i < moment.signals->size(); ++i) {
      const traffic::SignalState& signal = (*moment.signals)[i];
      const auto link = static_cast<std::size_t>(line.link);
      if (signal.id != line.id || link >= signal.state.size()) continue;
      if (signal.state[link] == 'r' || signal.state[link] == 'R') return std::make_pair(i, link);
    }
  }
  return std::nullopt;
}

/// A car ahead on the route that has always driven at a share of the vehicle's speed.
bool insertLeader(ChangedMoment& changed, const ExampleDraws& draws) {
  constexpr double kMoving = 2.0;  // [m/s]
  const TrackPoint own = changed.own();
  const PlutoMoment& moment = changed.moment;
  if (own.state.speed < kMoving) return false;
  const double gap = draws.uniform(kGapDraw, 8.0, 8.0 + 1.5 * own.state.speed);
  const double speed = own.state.speed * draws.uniform(kSlowDraw, 0.0, 0.8);
  const double place = moment.arc_length + gap;
  if (place > moment.route->length()) return false;
  traffic::Vehicle leader;
  leader.id = "inserted leader";
  TrackPoint point;
  point.vehicle = changed.vehicles.numberOf(leader);
  for (std::size_t i = 0; i < changed.frames.size(); ++i) {
    const auto ago = static_cast<double>(changed.frames.size() - 1 - i);
    const double then = place - speed * kPlutoPeriod * ago;
    point.state.position = moment.route->path().extendedPoseAt(then).position;
    point.state.heading = moment.route->path().headingAt(then);
    point.state.elevation = own.state.elevation;
    point.state.speed = speed;
    const bool now = i + 1 == changed.frames.size();
    if (now && !isFree(moment, point.state)) return false;
    changed.frames[i].points.push_back(point);  // the largest number, so in order
  }
  return true;
}

}  // namespace

ChangedMoment::ChangedMoment(const PlutoMoment& from)
    : vehicles(*from.vehicles), signals(*from.signals), moment(from) {
  for (const TrackFrame* frame : from.frames) frames.push_back(*frame);
  moment.frames.clear();
  for (const TrackFrame& frame : frames) moment.frames.push_back(&frame);
  moment.vehicles = &vehicles;
  moment.signals = &signals;
}

TrackPoint& ChangedMoment::own() {
  return const_cast<TrackPoint&>(*frames.back().find(moment.own));
}

void ChangedMoment::remove(const std::set<std::uint32_t>& gone) {
  for (TrackFrame& frame : frames) {
    const auto leaves = [&](const TrackPoint& point) { return gone.count(point.vehicle) != 0; };
    frame.points.erase(std::remove_if(frame.points.begin(), frame.points.end(), leaves),
                       frame.points.end());
  }
}

void disturbOwn(ChangedMoment& changed, const OwnDisturbance& most, const ExampleDraws& draws) {
  const double limits[] = {most.along, most.across,       most.turn,
                           most.speed, most.acceleration, most.steer};
  const TrackPoint before = changed.own();
  TrackPoint& own = changed.own();
  double share = 1.0;
  for (int halvings = 0; halvings <= 5; ++halvings, share *= 0.5) {
    double noise[6];
    for (std::uint32_t i = 0; i < 6; ++i)
      noise[i] = share * draws.uniform(kNoiseDraw + i, -limits[i], limits[i]);
    own = before;
    own.state.position = before.state.pose().toMap({noise[0], noise[1]});
    own.state.heading = core::wrapAngle(before.state.heading + noise[2]);
    own.state.speed = std::max(0.0, before.state.speed + noise[3]);
    own.acceleration = before.acceleration + static_cast<float>(noise[4]);
    own.steer = std::clamp(before.steer + static_cast<float>(noise[5]), -1.0F, 1.0F);
    if (!isFree(changed.moment, own.state)) continue;
    const double place = changed.moment.arc_length;
    changed.moment.arc_length = planning::extendedProjection(
        *changed.moment.route, own.state.position, place - kShift, place + kShift);
    return;
  }
  own = before;
}

PlutoExample plutoExample(const PlutoScene& scene, const PlutoPlace& place,
                          const PlutoMoment& moment, bool imitates) {
  const PlutoSceneBuilder& builder = scene.world().builder;
  const std::vector<ReferenceLine> lines = builder.linesOf(moment);
  const traffic::VehicleState& own = moment.point().state;
  PlutoExample example;
  example.input = builder.inputOf(moment, lines);
  example.target = plutoTarget(scene, place, own.pose(), lines);
  for (const PlutoAgent& agent : example.input.agents) {
    const bool recorded = scene.frames()[place.decision].find(agent.vehicle) != nullptr;
    example.futures.push_back(recorded ? agentFuture(scene, place.decision, agent.vehicle)
                                       : AgentFuture{});
  }
  example.world = &scene.world();
  example.frame = own.pose();
  example.size = moment.vehicles->size(moment.own);
  example.imitates = imitates;
  return example;
}

std::set<std::uint32_t> interactingVehicles(const PlutoScene& scene, const PlutoPlace& place) {
  const std::uint32_t own = scene.drives()[place.drive].vehicle;
  const auto way = statesAhead(scene, place.decision, own);
  std::set<std::uint32_t> found;
  for (const TrackPoint& point : scene.frames()[place.decision].points) {
    constexpr double kReach = 120.0;  // [m]
    if (point.vehicle == own || (point.state.position - way.front().position).norm() > kReach)
      continue;
    if (traffic::onDifferentLevels(point.state.elevation, way.front().elevation)) continue;
    const auto other = statesAhead(scene, place.decision, point.vehicle);
    if (meet(way, scene.vehicles().size(own), other, scene.vehicles().size(point.vehicle)))
      found.insert(point.vehicle);
  }
  return found;
}

std::unique_ptr<ChangedMoment> positiveMoment(const PlutoScene& scene, const PlutoPlace& place,
                                              const ExampleDraws& draws) {
  auto changed = std::make_unique<ChangedMoment>(scene.moment(place.decision, place.drive));
  disturbOwn(*changed, {}, draws);
  if (draws.uniform(kDropsDraw, 0.0, 1.0) >= 0.5) return changed;
  const std::set<std::uint32_t> needed = interactingVehicles(scene, place);
  const double share = draws.uniform(kDropShareDraw, 0.1, 1.0);
  std::set<std::uint32_t> gone;
  for (const TrackPoint& point : changed->frames.back().points) {
    const bool kept = point.vehicle == changed->moment.own || needed.count(point.vehicle) != 0;
    if (!kept && draws.uniform(kDropDraw + point.vehicle, 0.0, 1.0) < share)
      gone.insert(point.vehicle);
  }
  changed->remove(gone);
  return changed;
}

std::unique_ptr<ChangedMoment> negativeMoment(const PlutoScene& scene, const PlutoPlace& place,
                                              const ExampleDraws& draws) {
  auto changed = std::make_unique<ChangedMoment>(scene.moment(place.decision, place.drive));
  if (const auto red = redLight(changed->moment)) {
    changed->signals[red->first].state[red->second] = 'G';
    return changed;
  }
  const std::set<std::uint32_t> others = interactingVehicles(scene, place);
  const bool inserts = others.empty() || draws.uniform(kNegativeDraw, 0.0, 1.0) < 0.5;
  if (inserts && insertLeader(*changed, draws)) return changed;
  if (others.empty()) return nullptr;
  changed = std::make_unique<ChangedMoment>(scene.moment(place.decision, place.drive));
  changed->remove(others);
  return changed;
}

}  // namespace cdiff::planners
