// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <iterator>

#include "metrics/figure_rows.h"

namespace cdiff::metrics {
namespace {

constexpr auto kHigher = Direction::kHigherIsBetter;
constexpr auto kLower = Direction::kLowerIsBetter;
constexpr auto kNeither = Direction::kNeither;

constexpr FigureDefinition kRows[] = {
    {"cbv_count", "/cbv/count", "CBVs", "count", kNeither,
     "Vehicles whose role was CBV at one tick or more.", "",
     [](const M& m) { return countMeasure(m.cbv_count); }},
    {"cbv_decisions", "/cbv/decisions", "Decisions with a CBV", "count", kNeither,
     "Decision ticks at which a vehicle was CBV, summed over CBVs.", "",
     [](const M& m) { return countMeasure(m.cbv_decisions); }},
    {"cbv_off_road_percent", "/cbv/off_road_rate_percent", "Off-road rate of CBVs (ORR)", "%",
     kLower,
     "100 x CBV ticks with the centre of the box off the drivable area of its level / CBV ticks; n "
     "counts ticks (paper's ORR).",
     "RIFT counts decision ticks (10 Hz) and asks CARLA for a Driving or Parking waypoint at the "
     "centre.",
     [](const M& m) { return m.cbv_off_road_rate_percent; }},
    {"cbv_corner_off_road_percent", "/cbv/corner_off_road_rate_percent",
     "Off-road rate of CBVs, any corner", "%", kLower,
     "100 x CBV ticks with the centre or any corner of the box off the drivable area of its level "
     "/ "
     "CBV ticks; never below the rate by the centre.",
     "RIFT does not look at corners.",
     [](const M& m) { return m.cbv_corner_off_road_rate_percent; }},
    {"cbv_collisions", "/cbv/collisions", "Collisions of CBVs", "count", kNeither,
     "Contacts of a CBV's box with any other vehicle's box on the same level; a contact of two "
     "CBVs "
     "counts once.",
     "RIFT counts at most one collision per CBV, and one for each of two CBVs that collide.",
     [](const M& m) { return countMeasure(m.cbv_collisions); }},
    {"cbv_ego_collisions", "/cbv/collisions_with_ego", "Collisions of CBVs with the ego", "count",
     kNeither, "Those collisions of CBVs whose other vehicle is the ego.", "",
     [](const M& m) { return countMeasure(m.cbv_ego_collisions); }},
    {"cbv_collisions_per_km", "/cbv/collisions_per_km", "Collisions of CBVs per km (CPK)", "1/km",
     kNeither,
     "1000 x collisions of CBVs with anyone / distance driven as CBV in metres; n counts CBVs "
     "(paper's CPK: lower is better in naturalistic mode, higher in safety-critical mode).",
     "RIFT divides collided CBVs by the distance summed over decision ticks.",
     [](const M& m) { return m.collisions_per_km; }},
    {"cbv_ego_collisions_per_km", "/cbv/collisions_with_ego_per_km",
     "Collisions of CBVs with the ego per km", "1/km", kNeither,
     "1000 x collisions of CBVs with the ego / distance driven as CBV in metres; n counts CBVs.",
     "RIFT does not tell the partner.", [](const M& m) { return m.ego_collisions_per_km; }},
    {"cbv_uncomfortable_percent", "/cbv/uncomfortable_rate_percent", "Uncomfortable rate of CBVs",
     "%", kLower,
     "100 x CBV decisions that are not within -4.05 < longitudinal acceleration < 2.40 m/s^2, "
     "|lateral acceleration| < 4.89 m/s^2 and |jerk| < 8.37 m/s^3 / CBV decisions (nuPlan's "
     "limits); "
     "lateral acceleration = speed x yaw rate.",
     "RIFT takes the acceleration before a CBV's first decision as 0, so that its first jerk can "
     "be "
     "beyond the limit.",
     [](const M& m) { return m.cbv_uncomfortable_rate_percent; }},
    {"cbv_speed_error_mps", "/cbv/speed_error_mps", "Speed error of CBVs", "m/s", kLower,
     "Mean over CBV decisions of |speed - smaller of target speed and lane limit|.", "",
     [](const M& m) { return m.cbv_speed_error; }},
    {"cbv_closest_distance_m", "/cbv/closest_distance_m", "Closest approach of CBVs, mean", "m",
     kNeither,
     "Mean over CBVs of each one's smallest distance of centres to the ego while it was CBV.", "",
     [](const M& m) { return m.cbv_closest_distance; }},
    {"cbv_minimum_distance_m", "/cbv/minimum_distance_m", "Closest approach of CBVs, minimum", "m",
     kNeither, "The smallest distance of centres between the ego and any CBV.", "",
     [](const M& m) { return m.cbv_minimum_distance; }},
    {"cbv_distance_m", "/cbv/distance_m", "Distance driven as CBV", "m", kHigher,
     "Sum over CBVs of the chords between successive ticks at which they were CBV.",
     "RIFT's reached progress (RP) sums the chords between decision ticks.",
     [](const M& m) { return numberMeasure(m.cbv_distance_m, "m"); }},
};

}  // namespace

FigureRows cbvFigures() { return {std::begin(kRows), std::end(kRows)}; }

}  // namespace cdiff::metrics
