// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "planners/registry.h"
#include "session/scenario_options.h"

namespace cdiff::session {

// A request for a session, and how it is resolved to one scenario.

/// How planners that sample and are guided work unless a scenario says otherwise: a preset below
/// all single keys. Methods are YAML files of it in config/methods: `paper` is the published
/// method, `default` what the package recommends.
struct MethodOptions {
  std::string naturalistic_profile;     ///< guidance profile of CBVs in mode naturalistic
  std::string challenging_profile;      ///< in mode challenging
  std::string safety_critical_profile;  ///< and in mode safety_critical
  std::string ego_profile;              ///< of an ego whose planner can be guided
  planning::PlannerOptionsTable planner_options = planners::defaultOptions();

  void describe(core::OptionsVisitor& visitor);
  const std::string& profileOf(const std::string& mode) const;
};

/// Throws InputError naming the nearest shipped method for an unknown name.
MethodOptions loadMethod(const std::string& name);

/// Names of the shipped methods, sorted.
std::vector<std::string> shippedMethods();

/// What a method is called whose values were changed by single keys.
inline constexpr const char* kCustomMethod = "custom";

/// By which method the planners of a scenario work: what the planners with a network and the
/// guidance of guided planners have, compared with the shipped method that the scenario names.
struct MethodUse {
  std::string name;                  ///< of the shipped method, or kCustomMethod
  std::string preset;                ///< the shipped method that the scenario names
  std::vector<std::string> changed;  ///< keys that differ from it; empty unless custom
};

/// Of a resolved scenario. Where no planner of it has a network, nothing counts as changed.
MethodUse methodOf(const ScenarioOptions& scenario);

/// For people: "default", "custom (paper but for diffusion.hysteresis)".
std::string methodText(const MethodUse& method);

// Samples of one quantity from a file, in the file's unit: one number a line, or the JSON that
// `cdiff metric shapiro_wilk` reads.

/// Lines: one finite number each; empty lines and what follows '#' are skipped. JSON (the file
/// starts with '{'): {"cases": [{"x": [...]}, ...]}, the samples of all cases together. Throws
/// InputError naming file, line (or case) and what was expected, also for a file without a sample.
std::vector<double> readSamples(const std::filesystem::path& file);

/// Preset of the protocol where a scenario names none, so that a route of any length can be driven;
/// Bench2Drive's routes have the one of their benchmark.
inline constexpr const char* kUsualProtocol = "any_length";

/// A scenario that sets no key, as resolveRequest resolves it: what every key has by default.
ScenarioOptions defaultScenario();

/// What a user asks for on a command line or in a launch file, resolved to one scenario.
/// Empty texts mean "not given".
struct SessionRequest {
  std::string scenario;     ///< shipped name or file, also *.xosc
  std::string bench2drive;  ///< Bench2Drive route file, instead of a scenario
  std::string route;        ///< id of a route in it
  std::string network;      ///< network; replaces the scenario's
  std::string mode;
  std::string ego_planner;
  std::string cbv_planner;
  std::string seed;
  std::optional<std::vector<SteeringEntry>> steering{};  ///< instead of the scenario's list
  bool video = false;                                    ///< session.mp4 too
  bool ignore_unsupported = false;                       ///< elements of an OpenSCENARIO file
  std::vector<std::string> set;                          ///< "key=value" each, applied last
  std::string set_source = "--set";                      ///< how the user knows `set`, for errors
};

/// The scenario with everything that was asked for applied and validated. Throws InputError.
ScenarioOptions resolveRequest(const SessionRequest& request);

}  // namespace cdiff::session
