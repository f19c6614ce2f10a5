// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "diffusion/network/architecture.h"
#include "e2e_cdiff/core/options.h"
#include "learning/samples/driving_sample.h"
#include "session/scenario_options.h"
#include "session/session_setup.h"

namespace cdiff::collection {

/// Disturbances of what the recorded planner commands, and of where it starts.
struct NoiseOptions {
  double interval = 6.0;            ///< mean time from one burst to the next of a vehicle [s]
  double minimum_time = 0.3;        ///< shortest burst [s]
  double maximum_time = 0.8;        ///< longest burst [s]
  double steer = 0.45;              ///< largest addition to the steering, up to steer_speed
  double steer_speed = 3.5;         ///< faster vehicles get less: steer x steer_speed / speed [m/s]
  double pedal = 0.6;               ///< largest addition to throttle or brake
  double stall_share = 0.15;        ///< share of bursts that stop a moving vehicle instead
  double stall_minimum_time = 3.0;  ///< shortest stop, braking included [s]
  double stall_maximum_time = 6.0;  ///< longest stop [s]
  double lateral = 0.4;             ///< standard deviation of the place at the take-over [m]
  double heading = 5.0;             ///< standard deviation of the heading at the take-over [deg]

  void describe(core::OptionsVisitor& visitor);
};

/// Options of data collection: how many vehicles are driven, on which routes, how they are
/// disturbed, and how often an image is taken (SI units).
struct CollectionOptions {
  std::int64_t vehicles = 12;         ///< background vehicles driven at a time
  double duration = 60.0;             ///< longest session [s]
  double image_period = 0.5;          ///< between two images of a vehicle [s]
  double minimum_speed = 5.0;         ///< lowest target speed of a vehicle [m/s]
  double maximum_speed = 12.0;        ///< highest target speed of a vehicle [m/s]
  double maximum_gap = 7.0;           ///< largest s0 behind a leader, drawn from 4 m on [m]
  double maximum_headway = 1.2;       ///< largest T behind a leader, drawn from 0.25 s on [s]
  std::string pedals = "even";        ///< even | published (PDM-Lite's, full or none)
  double minimum_acceleration = 1.5;  ///< least a of an even vehicle [m/s^2]
  double maximum_acceleration = 3.5;  ///< largest a of an even vehicle [m/s^2]
  double minimum_deceleration = 2.0;  ///< least b of an even vehicle [m/s^2]
  double maximum_deceleration = 4.0;  ///< largest b of an even vehicle [m/s^2]
  double radius = 150.0;              ///< vehicles within this distance of the ego are driven [m]
  double spacing = 12.0;              ///< desired between driven vehicles when they are chosen [m]
  double minimum_route = 120.0;       ///< shorter routes are not taken [m]
  double route_length = 250.0;        ///< length of a vehicle's route, where the network allows [m]
  double route_end = 40.0;            ///< released with less of its route left [m]
  double off_road_distance = 3.0;     ///< released farther outside the drivable area [m]
  double standing_time = 8.0;         ///< released after standing this long [s]
  double pause = 3.0;                 ///< before a released vehicle may be driven again [s]
  double lane_change_share = 0.15;    ///< share of changes on lanes of over 60 m
  double program_lights_share = 0.4;  ///< share of sessions with the lights' own programs
  double minimum_density = 18.0;      ///< fewest vehicles near the ego, of generated demand
  double maximum_density = 45.0;      ///< most vehicles near the ego, of generated demand
  double standing_share = 0.25;       ///< part kept of samples that stand all the time
  double offset_share = 0.2;          ///< part of moving samples that is displaced once more
  double offset_lateral = 0.75;       ///< largest displacement to the side [m]
  double offset_heading = 12.0;       ///< largest turn of a displaced vehicle [deg]
  std::string sight = "all";      ///< what the expert knows of others: all | camera (what it shows)
  std::string policy;             ///< planner that drives CBVs now and then; empty: none
  double policy_period = 8.0;     ///< from one such time of a vehicle to the next [s]
  double policy_time = 4.0;       ///< longest time that it drives, drawn from a quarter on [s]
  double policy_share = 0.7;      ///< share of the periods in which it drives
  std::int64_t policy_plans = 0;  ///< of diffusion.model, of which one makes a further sample
  NoiseOptions noise;

  void describe(core::OptionsVisitor& visitor);
  /// Throws InputError for fields that contradict each other.
  void validate() const;
};

/// How training samples are made of what was recorded.
struct DatasetOptions {
  diffusion::Architecture architecture;  ///< horizon, image size, route tokens
  double standing_share = 0.25;          ///< part kept of samples that stand all the time
  double offset_share = 0.2;             ///< part of moving samples that is displaced once more
  double offset_lateral = 0.75;          ///< largest displacement to the side [m]
  double offset_heading = 12.0;          ///< largest turn of a displaced vehicle [deg]
  std::int64_t policy_plans = 0;         ///< plans of diffusion.model a moving sample (PolicyPlans)
  std::function<double(const std::string&)> target_speed;  ///< v* by vehicle [m/s]; empty: unknown
};

/// Those that a collection's own options give.
DatasetOptions datasetOptions(const CollectionOptions& options);

/// How long before a sample's image the one before it was seen [s].
inline constexpr double kPreviousInterval = 0.4;

/// The schema that such samples fit.
learning::DrivingSchema schemaOf(const diffusion::Architecture& architecture);

// The scenario of a session that collects data, made of one that is driven.

/// The scenario as collection runs it: its protocol ends it only after the duration (or with the
/// ego's route); lights and density of generated demand are drawn from the seed, and every other
/// seed generates the demand of a scenario that brings a file. The expert, a scenario's default ego
/// planner, takes the place of planners that see, for they learn from it.
session::ScenarioOptions collectionScenario(session::ScenarioOptions scenario,
                                            const CollectionOptions& options);

/// Its set-up, with the ego route lengthened by random turns to what the duration needs, and
/// PDM-Lite following as each vehicle's driver does (driverOf).
std::unique_ptr<session::SessionSetup> collectionSetup(const session::ScenarioOptions& scenario,
                                                       const CollectionOptions& options);

// What `cdiff collect` is asked for: options of a session, and where its files lie in the data
// set's folder.

/// One session.
struct CollectRequest {
  std::string scenario;  ///< shipped name or file
  std::int64_t seed = 1;
  std::filesystem::path results;
  double duration = 60.0;  ///< [s]
  bool keep_bag = false;
  bool images = true;            ///< without: no shard
  bool scenes = false;           ///< store scenes (learning/samples/scene.h)
  std::vector<std::string> set;  ///< key=value each
};

/// Options of a session, collection's own in the group "collection".
struct CollectSettings {
  session::ScenarioOptions scenario;
  CollectionOptions collection;

  void describe(core::OptionsVisitor& visitor);
};

/// Throws InputError for an unknown scenario, key or value, and for a route of Bench2Drive.
CollectSettings resolveCollection(const CollectRequest& request);
/// "SCENARIO_seedN": the name of its files.
std::string sessionName(const CollectSettings& settings);
std::filesystem::path bagFile(const CollectRequest& request, const std::string& name);
std::filesystem::path shardFile(const CollectRequest& request, const std::string& name);
std::filesystem::path sceneFile(const CollectRequest& request, const std::string& name);
std::filesystem::path statisticsFile(const CollectRequest& request, const std::string& name);

}  // namespace cdiff::collection
