// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <algorithm>
#include <numeric>
#include <optional>

#include "e2e_cdiff/metrics/metric.h"
#include "metrics/formulas/driving_score.h"
#include "metrics/formulas/sample_statistics.h"
#include "metrics/known_measures.h"

namespace cdiff::metrics {

const MeasureDefinition known::kDrivingScore = {
    "ego_driving_score",
    "/ego/driving_score",
    "Driving score",
    "",
    Direction::kHigherIsBetter,
    Subject::kEgo,
    "Route completion x infraction penalty by the rules of the protocol (CARLA leaderboard).",
    "",
    3,
    true,
    kMeanToHundred,
};
const MeasureDefinition known::kPenalty = {
    "ego_penalty",
    "/ego/penalty",
    "Penalty of the infractions",
    "",
    Direction::kHigherIsBetter,
    Subject::kEgo,
    "Infraction penalty by the rules of the protocol, 0 to 1: a product of factors (CARLA "
    "leaderboard 2.0, Bench2Drive, RIFT) or 1 / (1 + sum of charges) (leaderboard 2.1); n counts "
    "ticks with the ego.",
    "",
    3,
    false,
    kMeanToOne,
};
const MeasureDefinition known::kOutsideLanes = {
    "ego_infraction_outside_lanes_percent",
    "/ego/infractions/outside_lanes_percent",
    "Distance outside the lanes",
    "%",
    Direction::kLowerIsBetter,
    Subject::kEgo,
    "Share of the completed route outside the lanes or on a wrong lane (docs/protocols.md).",
    "",
    3,
    false,
    kMeanToHundred,
};
const MeasureDefinition known::kRedLights = {
    "ego_infraction_red_lights",
    "/ego/infractions/red_lights",
    "Red lights run",
    "",
    Direction::kLowerIsBetter,
    Subject::kEgo,
    "Stop lines crossed at red; n counts lines with a light crossed (docs/protocols.md).",
    "",
    3,
    false,
    kEvents,
};
const MeasureDefinition known::kStopSigns = {
    "ego_infraction_stop_signs",
    "/ego/infractions/stop_signs",
    "Stop signs run",
    "",
    Direction::kLowerIsBetter,
    Subject::kEgo,
    "Lines with a stop sign crossed without a stop; n counts lines with a stop sign crossed "
    "(docs/protocols.md).",
    "",
    3,
    false,
    kEvents,
};

namespace {

constexpr MeasureDefinition kSpeedMissed = {
    "ego_infraction_minimum_speed_missed",
    "/ego/infractions/minimum_speed_missed",
    "Stretches below the traffic's speed",
    "",
    Direction::kLowerIsBetter,
    Subject::kEgo,
    "Stretches of the route on which the ego was slower than the traffic; n counts stretches "
    "(docs/protocols.md).",
    "",
    3,
    false,
    kEvents,
};
constexpr MeasureDefinition kSpeedPercent = {
    "ego_infraction_minimum_speed_percent",
    "/ego/infractions/minimum_speed_percent",
    "Speed against the traffic's",
    "%",
    Direction::kHigherIsBetter,
    Subject::kEgo,
    "Mean over stretches of the route of 100 x mean speed of the ego / mean speed of the "
    "background vehicles (docs/protocols.md).",
    "",
    3,
    false,
    kPlainMean,
};
/// An infraction of CARLA's leaderboard that cannot happen here.
constexpr MeasureDefinition absentInfraction(const char* name, const char* place, const char* label,
                                             const char* why) {
  return {name, place, label, "",     Direction::kLowerIsBetter, Subject::kEgo, why,
          "",   3,     false, kEvents};
}
constexpr MeasureDefinition kPedestrians = absentInfraction(
    "ego_infraction_pedestrian_collisions", "/ego/infractions/pedestrian_collisions",
    "Collisions with pedestrians", "Always absent: contacts with pedestrians are not told apart.");
constexpr MeasureDefinition kTimeouts = absentInfraction(
    "ego_infraction_scenario_timeouts", "/ego/infractions/scenario_timeouts", "Scenario time-outs",
    "Always absent: scripted scenarios have no time limit of their own.");
constexpr MeasureDefinition kStaticCollisions = absentInfraction(
    "ego_infraction_static_collisions", "/ego/infractions/static_collisions",
    "Collisions with static objects", "Always absent: contacts with objects are not told apart.");
constexpr MeasureDefinition kVehicleCollisions = {
    "ego_infraction_vehicle_collisions",
    "/ego/infractions/vehicle_collisions",
    "Collisions that the protocol charges",
    "",
    Direction::kLowerIsBetter,
    Subject::kEgo,
    "Contacts of the ego that the protocol counts as collisions; n counts all contacts "
    "(docs/protocols.md).",
    "",
    3,
    false,
    kEvents,
};
constexpr MeasureDefinition kYieldsFailed =
    absentInfraction("ego_infraction_yields_failed", "/ego/infractions/yields_failed",
                     "Failures to yield to emergency vehicles",
                     "Always absent: these sessions have no emergency vehicles.");

constexpr MeasureDefinition kScoreUnderAttack = {
    "ego_driving_score_under_attack",
    "/ego/driving_score_under_attack",
    "Driving score under attack",
    "",
    Direction::kHigherIsBetter,
    Subject::kEgo,
    "Driving score of a session in mode challenging or safety_critical; absent in mode "
    "naturalistic, "
    "so that the mean over a batch is that of its attacks.",
    "",
    3,
    false,
    kMeanToHundred,
};

Measure counted(std::size_t count, std::size_t n) {
  return {static_cast<double>(count), n, {}, {}};
}

/// The ego's infractions by the protocol's rules and what they make of the driving score.
class DrivingScore final : public Metric {
 public:
  explicit DrivingScore(const MetricContext& context)
      : options_(context.options.infractions),
        attack_(context.options.mode != "naturalistic"),
        collisions_(options_),
        minimum_speed_(
            context.ego_route.length(),
            context.ego_route.empty() ? 0 : static_cast<std::size_t>(options_.speed_checkpoints)) {
    const map::RoadNetwork* network = context.options.network;
    if (network == nullptr) return;
    outside_.emplace(*network, options_);
    stop_lines_.emplace(*network, context.ego_route, options_);
  }

  void observe(const MetricTick& tick) override {
    completion_percent_ = tick.route_completion_percent;
    if (tick.ego == nullptr) return;
    if (tick.ego->state.position.allFinite()) observeEgo(*tick.ego, tick);
    for (const ContactSighting& contact : tick.contacts) {
      if (contact.ego_partner.empty()) continue;
      collisions_.observe(tick.snapshot.time, tick.ego->state, contact.ego_partner);
    }
  }

  void report(MetricSink& sink) const override {
    const Infractions found = infractions();
    const ScoreRules rules = options_.scoreRules();
    const Measure score =
        numberMeasure(ticks_ == 0 ? 0.0 : drivingScore(completion_percent_, found, rules));
    sink.set(known::kDrivingScore, score);
    sink.set(kScoreUnderAttack, attack_ ? score : absentMeasure("the mode is naturalistic"));
    sink.set(known::kPenalty, ticks_ == 0
                                  ? absentMeasure(kNoEgo)
                                  : Measure{infractionPenalty(found, rules), ticks_, {}, {}});
    sink.set(kVehicleCollisions, counted(collisions_.count(), collisions_.contacts()));
    reportRoad(sink);
    reportSpeed(sink);
    reportNotOccurring(sink);
  }

 private:
  void observeEgo(const traffic::Vehicle& ego, const MetricTick& tick) {
    ++ticks_;
    const double advance = std::max(0.0, tick.ego_arc_length - arc_length_);
    arc_length_ = std::max(arc_length_, tick.ego_arc_length);
    minimum_speed_.observe(arc_length_, ego.state.speed, tick.snapshot);
    if (outside_) outside_->observe(ego.state, advance);
    if (stop_lines_) stop_lines_->observe(ego, tick.snapshot.signals);
  }

  Infractions infractions() const {
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

  void reportRoad(MetricSink& sink) const {
    const Measure no_network = absentMeasure("no road network was given");
    sink.set(
        known::kRedLights,
        stop_lines_ ? counted(stop_lines_->redLights(), stop_lines_->lightsCrossed()) : no_network);
    sink.set(known::kStopSigns,
             stop_lines_ ? counted(stop_lines_->stopSigns(), stop_lines_->stopSignsCrossed())
                         : no_network);
    Measure outside = no_network;
    if (outside_ && arc_length_ > 0.0) outside = {outside_->percent(), outside_->ticks(), {}, {}};
    if (outside_ && !(arc_length_ > 0.0))
      outside = absentMeasure("the ego did not advance along its route");
    sink.set(known::kOutsideLanes, outside);
  }

  void reportSpeed(MetricSink& sink) const {
    const std::vector<double> percents = minimum_speed_.percents();
    if (percents.empty()) {
      const Measure absent = absentMeasure(
          options_.speed_checkpoints == 0
              ? "the protocol has no speed checkpoints"
              : "no stretch of the route was driven to its end beside moving background traffic");
      sink.set(kSpeedMissed, absent);
      sink.set(kSpeedPercent, absent);
      return;
    }
    const auto missed = std::count_if(percents.begin(), percents.end(),
                                      [](double percent) { return percent < 100.0; });
    const double sum = std::accumulate(percents.begin(), percents.end(), 0.0);
    sink.set(kSpeedMissed, counted(static_cast<std::size_t>(missed), percents.size()));
    sink.set(kSpeedPercent, {sum / static_cast<double>(percents.size()), percents.size(), {}, {}});
  }

  /// What the leaderboard charges and these sessions do not have.
  static void reportNotOccurring(MetricSink& sink) {
    sink.set(kPedestrians, absentMeasure("contacts with pedestrians are not told apart"));
    sink.set(kStaticCollisions, absentMeasure("contacts with objects are not told apart"));
    sink.set(kTimeouts, absentMeasure("scripted scenarios have no time limit of their own"));
    sink.set(kYieldsFailed, absentMeasure("these sessions have no emergency vehicles"));
  }

  InfractionOptions options_;
  bool attack_;
  CollisionCounter collisions_;
  MinimumSpeed minimum_speed_;
  std::optional<OutsideLanes> outside_;
  std::optional<StopLines> stop_lines_;
  double completion_percent_ = 0.0;
  double arc_length_ = 0.0;
  std::size_t ticks_ = 0;
};

}  // namespace

MetricDescriptor egoDrivingScoreMetric() {
  return {"ego_driving_score",
          "Driving score, penalty and infractions of the ego by the rules of the protocol.",
          {known::kDrivingScore, kScoreUnderAttack, known::kPenalty, kSpeedMissed, kSpeedPercent,
           known::kOutsideLanes, kPedestrians, known::kRedLights, kTimeouts, kStaticCollisions,
           known::kStopSigns, kVehicleCollisions, kYieldsFailed},
          [](const MetricContext& context) { return std::make_unique<DrivingScore>(context); }};
}

}  // namespace cdiff::metrics
