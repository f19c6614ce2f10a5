// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <iterator>

#include "figure_rows.h"

namespace cdiff::metrics {
namespace {

constexpr auto kHigher = Direction::kHigherIsBetter;
constexpr auto kLower = Direction::kLowerIsBetter;

constexpr FigureDefinition kRows[] = {
    {"ego_completion_percent", "/ego/route_completion_percent", "Route completion", "%", kHigher,
     "Share of the ego route's length up to the farthest place that the ego reached along it; 100 "
     "once the protocol's completion rule is met (CARLA leaderboard, RouteCompletionTest).",
     "", [](const M& m) { return numberMeasure(m.route_completion_percent, "%"); }},
    {"ego_driving_score", "/ego/driving_score", "Driving score", "", kHigher,
     "Route completion x infraction penalty by the rules of the protocol (CARLA leaderboard).", "",
     [](const M& m) { return numberMeasure(m.driving_score, ""); }},
    {"ego_collisions", "/ego/collisions", "Collisions of the ego", "count", kLower,
     "Contacts of the ego's box with any other vehicle's box on the same level; the same pair "
     "counts "
     "again only after 5 s without overlap.",
     "", [](const M& m) { return countMeasure(m.ego_collisions); }},
    {"ego_off_road_percent", "/ego/off_road_percent", "Ego off the road", "%", kLower,
     "100 x ticks with the centre of the ego's box off the drivable area of its level / ticks with "
     "the ego.",
     "", [](const M& m) { return m.ego_off_road_percent; }},
};

}  // namespace

FigureRows egoFigures() { return {std::begin(kRows), std::end(kRows)}; }

}  // namespace cdiff::metrics
