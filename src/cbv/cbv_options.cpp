// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "cbv/cbv_options.h"

#include "core/option_fields.h"
#include "core/text.h"
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
  visitor.number({"queue_speed", "m/s",
                  "A candidate that is slower on a lane of the ego's route waits in its queue."},
                 options.queue_speed, 0.0, 10.0);
  visitor.number({"clear_time", "s",
                  "For so long a vehicle that is taken over has no contact ahead; 0: only now."},
                 options.clear_time, 0.0, 10.0);
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
       "rift: a CBV stays one; reselect: released on a lost conflict or for a better one; by_mode: "
       "reselect in challenging, else rift."},
      options.life_cycle, {"rift", "reselect", "by_mode"});
  visitor.number({"hysteresis", "", "Reselect: by how much a challenger's score must be better."},
                 options.hysteresis, 0.0, 1.0);
  visitor.number(
      {"lost_conflict_time", "s", "Reselect: released after this long without a conflict."},
      options.lost_conflict_time, 0.0, 1000.0);
}

}  // namespace

void CbvOptions::describe(core::OptionsVisitor& visitor) {
  visitor.list({"only", "", "Ids of the vehicles that may become CBVs; empty: all may."}, only);
  visitor.text({"ranking", "",
                "Order in which candidates fill the slots: by score, nearest to the ego first, or "
                "whoever passes the gates, by id."},
               ranking, {"score", "nearest", "gates"});
  describeGates(*this, visitor);
  describeRoutes(*this, visitor);
  describeScore(*this, visitor);
  describeTimes(*this, visitor);
}

CbvOptions CbvOptions::inMode(const std::string& mode) const {
  CbvOptions options = *this;
  if (life_cycle == "by_mode") options.life_cycle = mode == "challenging" ? "reselect" : "rift";
  return options;
}

void CbvOptions::validate() const {
  core::requireRanges(*this, "CBV");
  if (minimum_distance >= search_radius) {
    throw core::InputError(
        "CBV option 'minimum_distance' is " + core::formatNumber(minimum_distance) +
        "; expected less than 'search_radius', " + core::formatNumber(search_radius));
  }
}

}  // namespace cdiff::cbv
