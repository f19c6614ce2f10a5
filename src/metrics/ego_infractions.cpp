// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "metrics/ego_infractions.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace cdiff::metrics {
namespace {

constexpr const char* kNoNetwork = "no road network was given";

Measure counted(std::size_t count, std::size_t n) {
  return {static_cast<double>(count), n, "", ""};
}

Measure absent(const std::string& unit, const std::string& reason) {
  return {std::nullopt, 0, unit, reason};
}

/// What the leaderboard charges and these sessions do not have.
std::map<std::string, Measure> notOccurring() {
  return {{"pedestrian_collisions", absent("", "these sessions have no pedestrians")},
          {"static_collisions", absent("", "these sessions have no static objects to hit")},
          {"scenario_timeouts", absent("", "these sessions have no scripted scenarios")},
          {"yields_failed", absent("", "these sessions have no emergency vehicles")}};
}

}  // namespace

EgoInfractions::EgoInfractions(const map::RoadNetwork* network, const map::Route& route,
                               const InfractionOptions& options)
    : options_(options),
      collisions_(options),
      minimum_speed_(route.length(),
                     route.empty() ? 0 : static_cast<std::size_t>(options.speed_checkpoints)) {
  if (network == nullptr) return;
  outside_.emplace(*network, options);
  stop_lines_.emplace(*network, route, options);
}

void EgoInfractions::observe(const traffic::Vehicle& ego, const traffic::TrafficSnapshot& snapshot,
                             double arc_length) {
  ++ticks_;
  const double advance = std::max(0.0, arc_length - arc_length_);
  arc_length_ = std::max(arc_length_, arc_length);
  minimum_speed_.observe(arc_length_, ego.state.speed, snapshot);
  if (outside_) outside_->observe(ego.state, advance);
  if (stop_lines_) stop_lines_->observe(ego, snapshot.signals);
}

void EgoInfractions::countCollision(const traffic::TrafficSnapshot& snapshot,
                                    const std::string& partner) {
  const traffic::Vehicle* ego = snapshot.ego();
  if (ego != nullptr) collisions_.observe(snapshot.time, ego->state, partner);
}

Infractions EgoInfractions::infractions() const {
  Infractions infractions;
  infractions.vehicle_collisions = collisions_.count();
  infractions.minimum_speed_percent = minimum_speed_.percents();
  if (outside_) infractions.outside_lanes_percent = outside_->percent();
  if (stop_lines_) {
    infractions.red_lights = stop_lines_->redLights();
    infractions.stop_signs = stop_lines_->stopSigns();
  }
  return infractions;
}

Measure EgoInfractions::penalty() const {
  if (ticks_ == 0) return absent("", "the ego was never seen");
  return {infractionPenalty(infractions(), options_.scoreRules()), ticks_, "", ""};
}

double EgoInfractions::drivingScore(double route_completion_percent) const {
  if (ticks_ == 0) return 0.0;
  return metrics::drivingScore(route_completion_percent, infractions(), options_.scoreRules());
}

std::map<std::string, Measure> EgoInfractions::measures() const {
  std::map<std::string, Measure> measures = notOccurring();
  measures["vehicle_collisions"] = counted(collisions_.count(), collisions_.contacts());
  addRoadMeasures(measures);
  addSpeedMeasures(measures);
  return measures;
}

void EgoInfractions::addRoadMeasures(std::map<std::string, Measure>& measures) const {
  measures["red_lights"] = absent("", kNoNetwork);
  measures["stop_signs"] = absent("", kNoNetwork);
  measures["outside_lanes_percent"] = absent("%", kNoNetwork);
  if (stop_lines_) {
    measures["red_lights"] = counted(stop_lines_->redLights(), stop_lines_->lightsCrossed());
    measures["stop_signs"] = counted(stop_lines_->stopSigns(), stop_lines_->stopSignsCrossed());
  }
  if (!outside_) return;
  measures["outside_lanes_percent"] = arc_length_ > 0.0
                                          ? Measure{outside_->percent(), outside_->ticks(), "%", ""}
                                          : absent("%", "the ego made no way along its route");
}

void EgoInfractions::addSpeedMeasures(std::map<std::string, Measure>& measures) const {
  const std::vector<double> percents = minimum_speed_.percents();
  if (percents.empty()) {
    const std::string reason = options_.speed_checkpoints == 0
                                   ? "the protocol has no speed checkpoints"
                                   : "no stretch of the route was driven to its end beside moving "
                                     "background traffic";
    measures["minimum_speed_missed"] = absent("", reason);
    measures["minimum_speed_percent"] = absent("%", reason);
    return;
  }
  double sum = 0.0;
  std::size_t missed = 0;
  for (const double percent : percents) {
    sum += percent;
    if (percent < 100.0) ++missed;
  }
  const auto n = static_cast<double>(percents.size());
  measures["minimum_speed_missed"] = counted(missed, percents.size());
  measures["minimum_speed_percent"] = {sum / n, percents.size(), "%", ""};
}

}  // namespace cdiff::metrics
