// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <iterator>

#include "metrics/figure_rows.h"

namespace cdiff::metrics {
namespace {

constexpr auto kHigher = Direction::kHigherIsBetter;
constexpr auto kLower = Direction::kLowerIsBetter;

/// Row of a key of the ego's infractions.
#define INFRACTION_FIGURE(key, label, unit, direction, definition)                          \
  {                                                                                         \
    "ego_infraction_" key, "/ego/infractions/" key, label, unit, direction, definition, "", \
        [](const M& m) { return infractionMeasure(m, key, unit); }                          \
  }

Measure infractionMeasure(const M& measures, const char* key, const char* unit) {
  const auto found = measures.infractions.find(key);
  if (found != measures.infractions.end()) return found->second;
  Measure absent;
  absent.unit = unit;
  absent.reason = "not computed";
  return absent;
}

constexpr FigureDefinition kRows[] = {
    {"ego_completion_percent", "/ego/route_completion_percent", "Route completion", "%", kHigher,
     "Share of the ego route's length up to the farthest place that the ego reached along it; 100 "
     "once the protocol's completion rule is met (CARLA leaderboard, RouteCompletionTest).",
     "", [](const M& m) { return numberMeasure(m.route_completion_percent, "%"); }},
    {"ego_driving_score", "/ego/driving_score", "Driving score", "", kHigher,
     "Route completion x infraction penalty by the rules of the protocol (CARLA leaderboard).", "",
     [](const M& m) { return numberMeasure(m.driving_score, ""); }},
    {"ego_penalty", "/ego/penalty", "Penalty of the infractions", "", kHigher,
     "Infraction penalty by the rules of the protocol, 0 to 1: a product of factors (CARLA "
     "leaderboard 2.0, Bench2Drive, RIFT) or 1 / (1 + sum of charges) (leaderboard 2.1); n counts "
     "ticks with the ego.",
     "", [](const M& m) { return m.penalty; }},
    INFRACTION_FIGURE("minimum_speed_missed", "Stretches below the traffic's speed", "", kLower,
                      "Stretches of the route on which the ego was slower than the traffic; n "
                      "counts stretches (docs/protocols.md)."),
    INFRACTION_FIGURE(
        "minimum_speed_percent", "Speed against the traffic's", "%", kHigher,
        "Mean over stretches of the route of 100 x mean speed of the ego / mean speed "
        "of the background vehicles (docs/protocols.md)."),
    INFRACTION_FIGURE("outside_lanes_percent", "Way outside the lanes", "%", kLower,
                      "Share of the completed route outside the lanes or on a wrong lane "
                      "(docs/protocols.md)."),
    INFRACTION_FIGURE("pedestrian_collisions", "Collisions with pedestrians", "", kLower,
                      "Always absent: these sessions have no pedestrians."),
    INFRACTION_FIGURE("red_lights", "Red lights run", "", kLower,
                      "Stop lines crossed at red; n counts lines with a light crossed "
                      "(docs/protocols.md)."),
    INFRACTION_FIGURE("scenario_timeouts", "Scenario time-outs", "", kLower,
                      "Always absent: these sessions have no scripted scenarios."),
    INFRACTION_FIGURE("static_collisions", "Collisions with static objects", "", kLower,
                      "Always absent: these sessions have no static objects to hit."),
    INFRACTION_FIGURE("stop_signs", "Stop signs run", "", kLower,
                      "Lines with a stop sign crossed without a stop; n counts lines with a stop "
                      "sign crossed (docs/protocols.md)."),
    INFRACTION_FIGURE("vehicle_collisions", "Collisions that the protocol charges", "", kLower,
                      "Contacts of the ego that the protocol counts as collisions; n counts all "
                      "contacts (docs/protocols.md)."),
    INFRACTION_FIGURE("yields_failed", "Failures to yield to emergency vehicles", "", kLower,
                      "Always absent: these sessions have no emergency vehicles."),
    {"ego_blocked", "/ego/blocked", "Ego blocked", "", kLower,
     "1 when the session ended because the ego stood still for the protocol's blocked time, else "
     "0.",
     "", [](const M& m) { return numberMeasure(m.blocked ? 1.0 : 0.0, ""); }},
    {"ego_collisions", "/ego/collisions", "Collisions of the ego", "count", kLower,
     "Contacts of the ego's box with any other vehicle's box on the same level; who touches it "
     "leaves at the next tick.",
     "", [](const M& m) { return countMeasure(m.ego_collisions); }},
    {"ego_contacts_at_fault", "/ego/contacts_at_fault", "Contacts that are the ego's fault",
     "count", kLower,
     "Of the ego's contacts, those in which it strikes the other, by their motion at first touch; "
     "a "
     "standing ego is never at fault (docs/protocols.md).",
     "", [](const M& m) { return countMeasure(m.contactsAtFault()); }},
    {"ego_off_road_percent", "/ego/off_road_percent", "Ego off the road", "%", kLower,
     "100 x ticks with the centre of the ego's box off the drivable area of its level / ticks with "
     "the ego.",
     "", [](const M& m) { return m.ego_off_road_percent; }},
};
#undef INFRACTION_FIGURE

}  // namespace

FigureRows egoFigures() { return {std::begin(kRows), std::end(kRows)}; }

}  // namespace cdiff::metrics
