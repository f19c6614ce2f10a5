// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "e2e_cdiff/core/options.h"
#include "e2e_cdiff/map/road_network.h"

namespace cdiff::metrics {

/// How infractions lower the driving score. Defaults: those of RIFT and Bench2Drive.
struct ScoreRules {
  bool charges = false;       ///< 1 / (1 + sum of charges) instead of a product of factors
  bool speed_counts = false;  ///< whether the minimum speed enters
};

/// What counts as an infraction of the ego and how the driving score charges it: rules of a
/// protocol preset (SI units).
/// Defaults: rift_dev10. Described without a group of its own: the keys lie beside the protocol's.
struct InfractionOptions {
  double collision_repeat_time = 5.0;  ///< the same partner again before is the same collision [s]
  double collision_repeat_distance = 5.0;  ///< nearer to the last collision is the same one [m]
  double collision_minimum_speed = 0.1;    ///< a slower ego did not cause its contact [m/s]
  double outside_lane_margin = 0.5;        ///< beyond a lane's border [m]
  double wrong_lane_angle = 120.0;  ///< a lane at a larger angle to the ego is a wrong one [deg]
  double stop_sign_distance = 4.0;  ///< before the line, within which to stop [m]
  double stop_sign_speed = 0.1;     ///< slower has stopped [m/s]
  std::int64_t speed_checkpoints = 20;  ///< stretches of the route with a minimum speed
  bool speed_counts = false;            ///< whether the minimum speed enters the score
  std::string penalty = "factors";      ///< factors | charges

  void describe(core::OptionsVisitor& visitor);  ///< visits every option
  /// How `penalty` and `speed_counts` charge the score.
  ScoreRules scoreRules() const;
};

/// What a scenario says about its metrics (group `metrics`): the speeds [m/s] that the speeds of
/// CBVs are compared with.
struct MetricsOptions {
  std::string speed_target = "background";  ///< background | normal | file
  double speed_target_mean = 8.0;           ///< mean of the normal distribution of speeds [m/s]
  double speed_target_deviation = 2.0;      ///< standard deviation of that distribution [m/s]
  std::string speed_target_file;            ///< speeds [m/s], one a line, or JSON
  /// Content of the file as texts; filled when the scenario is resolved, so that a recording needs
  /// no file.
  std::vector<std::string> speed_target_samples;

  void describe(core::OptionsVisitor& visitor);  ///< visits every option
  /// Throws InputError for a file target without file or samples, and for a sample that is no
  /// finite number.
  void validate() const;
  /// speed_target_samples as numbers [m/s].
  std::vector<double> samples() const;
};

/// What the metrics of a session know about its scenario (SI units).
struct SessionMetricsOptions {
  double simulation_step = 0.05;          ///< [s]
  double decision_period = 0.1;           ///< [s]
  double completion_percent = 99.0;       ///< the protocol's bound on route completion
  double completion_distance = 10.0;      ///< the protocol's bound on the distance to the goal [m]
  std::string protocol = "rift_dev10";    ///< name of the preset
  std::string mode = "naturalistic";      ///< naturalistic | challenging | safety_critical
  InfractionOptions infractions;          ///< its rules for the ego
  double ttc_radius = 60.0;               ///< vehicles considered for 2D-TTC [m]
  double ttc_limit = 3600.0;              ///< a longer 2D-TTC counts as never [s]
  double post_encroachment_limit = 10.0;  ///< a longer time counts as never [s]
  double target_speed = 8.0;              ///< that CBVs aim at, capped by the lane's limit [m/s]
  /// The same of each CBV by its id; empty: target_speed for all.
  std::function<double(const std::string& vehicle_id)> cbv_target_speed{};
  const map::RoadNetwork* network =
      nullptr;             ///< for that limit and the ego's infractions; nullptr: without
  MetricsOptions metrics;  ///< what the scenario asks for
};

}  // namespace cdiff::metrics
