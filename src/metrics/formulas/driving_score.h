// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "e2e_cdiff/map/road_network.h"
#include "e2e_cdiff/map/route.h"
#include "e2e_cdiff/metrics/metrics_options.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"
#include "e2e_cdiff/traffic/vehicle.h"

namespace cdiff::metrics {

// Driving score [%] of CARLA's leaderboard: route completion x penalty, never negative; the penalty
// is a product of factors (2.0) or 1 / (1 + sum of charges) (2.1).

/// What happened on a route.
struct Infractions {
  std::size_t pedestrian_collisions = 0;
  std::size_t vehicle_collisions = 0;
  std::size_t static_collisions = 0;
  std::size_t red_lights = 0;
  std::size_t stop_signs = 0;
  std::size_t scenario_timeouts = 0;
  std::size_t yields_failed = 0;  ///< to emergency vehicles
  std::vector<double>
      minimum_speed_percent;           ///< per checkpoint: own mean speed / that of the traffic [%]
  double outside_lanes_percent = 0.0;  ///< part of the completed route outside the lanes, 0 to 100
};

/// In [0, 1]; 1 without infractions.
double infractionPenalty(const Infractions& infractions, const ScoreRules& rules);

/// In percent, from a route completion in percent.
double drivingScore(double route_completion_percent, const Infractions& infractions,
                    const ScoreRules& rules);

/// Counts the ego's collisions as CARLA's CollisionTest does: contacts with the same partner within
/// a time [s], or within a distance of the last collision [m], are one; those of a standing ego are
/// not charged.
class CollisionCounter {
 public:
  explicit CollisionCounter(const InfractionOptions& options) : options_(options) {}

  /// A contact of the ego that began at `time` [s]; times ascending.
  void observe(double time, const traffic::VehicleState& ego, const std::string& partner);
  std::size_t count() const { return count_; }
  /// Contacts seen, counted or not.
  std::size_t contacts() const { return contacts_; }

 private:
  struct Collision {
    double time;
    Eigen::Vector2d position;  ///< position of the ego
    std::string partner;
  };
  bool repeats(double time, const traffic::VehicleState& ego, const std::string& partner) const;

  InfractionOptions options_;
  std::optional<Collision> last_;
  std::size_t count_ = 0;
  std::size_t contacts_ = 0;
};

/// Own mean speed over the background traffic's [%] on equal stretches of the ego route, as CARLA's
/// MinimumSpeedRouteTest has it: 100 x mean over ticks of the ego's speed / mean over the same
/// ticks of the mean speed of all background vehicles.
class MinimumSpeed {
 public:
  /// A route of `length` [m] in `checkpoints` stretches; 0: none.
  MinimumSpeed(double length, std::size_t checkpoints);

  /// One tick, with the ego `arc_length` [m] along its route. Ticks without background vehicles do
  /// not enter.
  void observe(double arc_length, double ego_speed, const traffic::TrafficSnapshot& snapshot);
  /// Of each stretch that was driven to its end, the last one from 95 % of the route on; a stretch
  /// without moving background vehicles is left out [%].
  std::vector<double> percents() const;

 private:
  struct Stretch {
    double ego = 0.0;         ///< sum of speeds over ticks
    double background = 0.0;  ///< sum of mean speeds over the same ticks
  };
  double length_;
  std::size_t checkpoints_;
  std::size_t passed_ = 0;
  double arc_length_ = 0.0;
  Stretch open_;
  std::vector<double> percents_;
};

/// The rule at one tick. False for a position that is not finite.
bool isOutsideLanes(const map::RoadNetwork& network, const traffic::VehicleState& ego,
                    const InfractionOptions& options);

/// Share [%] of the completed route that the ego drove outside the lanes, as CARLA's
/// OutsideRouteLanesTest has it: its center farther than half a lane's width plus a margin from
/// every lane on its level, or the nearest lane outside junctions leading the other way.
class OutsideLanes {
 public:
  /// `network` must outlive the object.
  OutsideLanes(const map::RoadNetwork& network, const InfractionOptions& options)
      : network_(network), options_(options) {}

  /// One tick, by which the ego has come `advance` farther along its route [m].
  void observe(const traffic::VehicleState& ego, double advance);
  std::size_t ticks() const { return ticks_; }
  /// 0 before the ego has advanced.
  double percent() const { return advance_ > 0.0 ? 100.0 * outside_ / advance_ : 0.0; }

 private:
  const map::RoadNetwork& network_;
  InfractionOptions options_;
  std::size_t ticks_ = 0;
  double advance_ = 0.0;
  double outside_ = 0.0;
};

/// Stop lines that the ego crosses (map frame [m]): red lights run and stop signs not obeyed. A
/// line is a lane's end before a junction; it is crossed when the point 0.8 half lengths behind the
/// ego's center passes it inside the lane's width and on its level.
class StopLines {
 public:
  /// `network` must outlive the object. Of a lane on the ego route the link that the route takes
  /// counts; of another lane all links do, and a rule holds only where it holds for each.
  StopLines(const map::RoadNetwork& network, const map::Route& route,
            const InfractionOptions& options);

  /// One tick of the ego, with the lights' colors.
  void observe(const traffic::Vehicle& ego, const std::vector<traffic::SignalState>& signals);

  /// Lines crossed while the light showed red (r) or red-yellow (u).
  std::size_t redLights() const { return red_lights_; }
  /// Lines with a light crossed, whatever it showed.
  std::size_t lightsCrossed() const { return lights_crossed_; }
  /// Lines with a stop sign crossed without having stopped within the distance before them.
  std::size_t stopSigns() const { return stop_signs_; }
  std::size_t stopSignsCrossed() const { return stop_signs_crossed_; }

 private:
  using Links = std::vector<map::LaneLink>;
  /// The ego against one line: meters beyond it, and beside the lane's centerline.
  struct Place {
    double beyond = 0.0;
    double beside = 0.0;
  };
  Place placeAt(const map::Lane& lane, const Eigen::Vector2d& point) const;
  Links linksOf(map::LaneIndex lane) const;
  bool crosses(const map::Lane& lane, const Eigen::Vector2d& tail) const;
  void noteStop(const traffic::Vehicle& ego, const std::vector<map::LaneIndex>& lanes);
  void cross(map::LaneIndex lane, const std::vector<traffic::SignalState>& signals);

  const map::RoadNetwork& network_;
  InfractionOptions options_;
  std::vector<std::pair<map::LaneIndex, map::LaneIndex>> taken_;  ///< links of the route, sorted
  std::optional<Eigen::Vector2d> last_tail_;
  map::LaneIndex stopped_on_ = map::kNoLane;  ///< lane with a stop sign before whose line it stood
  std::size_t red_lights_ = 0;
  std::size_t lights_crossed_ = 0;
  std::size_t stop_signs_ = 0;
  std::size_t stop_signs_crossed_ = 0;
};

}  // namespace cdiff::metrics
