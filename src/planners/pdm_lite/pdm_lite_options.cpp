// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/pdm_lite/pdm_lite_options.h"

#include <map>
#include <vector>

#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/planning/planner_descriptor.h"
#include "planners/pdm_lite/pdm_lite.h"

namespace cdiff::planners {
namespace {

void requirePositive(const char* key, double value) {
  if (value > 0.0) return;
  throw core::InputError(std::string("pdm_lite: ") + key + " is " + core::formatNumber(value) +
                         ", but must be positive");
}

const std::map<std::string, PdmLiteConfiguration>& configurations() {
  static const std::map<std::string, PdmLiteConfiguration> known = {
      {"rift", {2.0, 20, 0.0}}, {"original", {3.118357247806046, 6, 20.0}}};
  return known;
}

std::vector<std::string> configurationNames() {
  std::vector<std::string> names;
  for (const auto& [name, constants] : configurations()) names.push_back(name);
  return names;
}

}  // namespace

void PdmLiteOptions::describe(core::OptionsVisitor& visitor) {
  visitor.text(
      {"configuration", "", "Constants of RIFT, or of the original at 20 decisions a second."},
      configuration, configurationNames());
  visitor.number({"speed_limit_share", "", "Initial target speed as a share of the limit."},
                 speed_limit_share, 0.05, 1.5);
  visitor.number({"top_speed", "m/s", "Cap of the initial target speed; 0: the configuration's."},
                 top_speed, 0.0, 60.0);
  visitor.number({"junction_speed", "m/s", "Cap when a junction lies within 30 m."}, junction_speed,
                 0.5, 60.0);
  visitor.number({"forecast_horizon", "s", "Horizon of the box forecasts."}, forecast_horizon, 0.1,
                 10.0);
  visitor.number({"detection_radius", "m", "Vehicles within it are forecast."}, detection_radius,
                 1.0, 500.0);
  lateral.describe(visitor, "lateral", "steering", "; 0: the configuration's");
  visitor.integer(
      {"lateral_window", "", "Errors in the mean of the steering; 0: the configuration's."},
      lateral_window, 0, 1000);
  visitor.flag({"obey_lights", "", "Stop for lights that are not green."}, obey_lights);
  visitor.flag({"obey_stop_signs", "", "Stop at stop signs."}, obey_stop_signs);
  visitor.number(
      {"cbv_acceleration", "m/s^2", "Of CBVs with even pedals; 0: PDM-Lite's, published."},
      cbv_acceleration, 0.0, 8.0);
  visitor.number({"cbv_deceleration", "m/s^2", "Comfortable, of CBVs with even pedals."},
                 cbv_deceleration, 0.5, 8.0);
  visitor.number({"cbv_speed_spread", "",
                  "Standard deviation of a CBV's factor on its target "
                  "speed; 0: one driver for all."},
                 cbv_speed_spread, 0.0, 0.5);
  visitor.number({"cbv_headway_spread", "s",
                  "Spread of the half-normal time that a CBV adds to its "
                  "time headway; 0: one driver for all."},
                 cbv_headway_spread, 0.0, 3.0);
}

void PdmLiteOptions::validate() const {
  requirePositive("speed_limit_share", speed_limit_share);
  requirePositive("junction_speed", junction_speed);
  requirePositive("forecast_horizon", forecast_horizon);
  requirePositive("detection_radius", detection_radius);
  resolved();
}

PdmLiteConfiguration PdmLiteOptions::resolved() const {
  const auto named = configurations().find(configuration);
  if (named == configurations().end()) {
    throw core::InputError("pdm_lite: configuration is '" + configuration + "'; expected one of " +
                           core::joinText(configurationNames(), ", "));
  }
  PdmLiteConfiguration constants = named->second;
  if (lateral.kp > 0.0) constants.lateral_kp = lateral.kp;
  if (lateral_window > 0) constants.lateral_window = lateral_window;
  if (top_speed > 0.0) constants.top_speed = top_speed;
  return constants;
}

planning::PlannerDescriptor pdmLiteDescriptor() {
  planning::PlannerDescriptor descriptor;
  descriptor.name = "pdm_lite";
  descriptor.title = "PDM-Lite";
  descriptor.help = "rules on the true positions of all vehicles, with IDM and forecast boxes.";
  descriptor.options = planning::makePlannerOptions<PdmLiteOptions>;
  descriptor.make = [](const planning::PlannerParts& parts) {
    return std::make_unique<PdmLite>(parts.options.of<PdmLiteOptions>(), parts.vehicle,
                                     parts.context);
  };
  return descriptor;
}

}  // namespace cdiff::planners
