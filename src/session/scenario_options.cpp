// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "session/scenario_options.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <pugixml.hpp>

#include "core/file.h"
#include "core/spelling.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/traffic/vehicle.h"
#include "planners/planner_by_slot.h"
#include "session/demand_file.h"
#include "session/steered_cbvs.h"
#include "session/unfit_combination.h"
#include "simulation/sumo_input_rules.h"

namespace cdiff::session {
namespace {

namespace fs = std::filesystem;
using core::InputError;

constexpr double kInfinite = 1e9;

bool isMultiple(double value, double unit) {
  const double ratio = value / unit;
  return std::abs(ratio - std::round(ratio)) < 1e-6 && ratio > 0.5;
}

void checkStatuses(const std::vector<std::string>& statuses) {
  using traffic::SessionStatus;
  std::vector<std::string> known;
  for (const SessionStatus status :
       {SessionStatus::kCompleted, SessionStatus::kBlocked, SessionStatus::kDeviated,
        SessionStatus::kTimedOut, SessionStatus::kCollided}) {
    known.emplace_back(traffic::toText(status));
  }
  for (const std::string& status : statuses) {
    if (std::find(known.begin(), known.end(), status) != known.end()) continue;
    throw InputError("key 'verdict.statuses' holds '" + status + "'; expected some of {" +
                     core::joinText(known, ", ") + "}" + core::didYouMean(status, known));
  }
}

/// SUMO reads "nan" and "inf" as numbers and breaks down over them when the session runs.
void requireFinite(const pugi::xml_node& element, const std::string& file) {
  for (const pugi::xml_attribute& attribute : element.attributes()) {
    std::string value = core::lowerCase(attribute.value());
    if (!value.empty() && (value.front() == '-' || value.front() == '+')) value.erase(0, 1);
    if (value != "nan" && value != "inf" && value != "infinity") continue;
    throw InputError("demand file '" + file + "': <" + element.name() + " id=\"" +
                     element.attribute("id").value() + "\">: attribute '" + attribute.name() +
                     "' is '" + attribute.value() + "'; expected a finite number");
  }
  for (const pugi::xml_node& child : element.children()) requireFinite(child, file);
}

/// What SUMO would refuse only when the session runs.
void checkDemandFile(const std::string& file) {
  const std::string text = core::readFile(file, "demand file");
  pugi::xml_document document;
  const pugi::xml_parse_result parsed = document.load_buffer(text.data(), text.size());
  if (!parsed) {
    throw InputError("demand file '" + file + "': not XML: " + parsed.description() +
                     " at offset " + std::to_string(parsed.offset));
  }
  const pugi::xml_node routes = document.child("routes");
  if (!routes) throw InputError("demand file '" + file + "': no <routes> element");
  simulation::requirePlainPath(file, "demand file '" + file + "'");
  simulation::requireHarmlessDemand(text, "demand file '" + file + "'");
  requireFinite(routes, file);
  for (const pugi::xml_node& element : routes.children()) {
    if (std::string(element.attribute("id").value()) != traffic::kEgoId) continue;
    throw InputError("demand file '" + file + "': <" + element.name() +
                     " id=\"ego\">: this id is the ego's; choose another");
  }
}

}  // namespace

VerdictOptions VerdictOptions::standard() {
  VerdictOptions rules;
  rules.minimum_route_completion = 90.0;
  rules.statuses = {"completed", "timed_out", "collided"};
  rules.maximum_contacts_at_fault = 0.0;
  rules.contact_without_fault = "by_mode";
  return rules;
}

bool VerdictOptions::excusesUnavoidable(const std::string& mode) const {
  if (excuse_unavoidable == "by_mode") return mode == "safety_critical";
  return excuse_unavoidable == "true";
}

void VerdictOptions::describe(core::OptionsVisitor& visitor) {
  visitor.flag({"judge", "", "Whether the rules below are applied."}, judge);
  visitor.number({"minimum_route_completion", "%", "Least route completion of the ego."},
                 minimum_route_completion, 0.0, 100.0);
  visitor.number({"maximum_contacts_at_fault", "", "Most contacts that are the ego's fault."},
                 maximum_contacts_at_fault, 0.0, kInfinite);
  visitor.text(
      {"excuse_unavoidable", "",
       "Whether a contact that no braking would have avoided is no fault; by_mode: true in "
       "safety_critical, false in naturalistic."},
      excuse_unavoidable, {"by_mode", "true", "false"});
  visitor.text({"contact_without_fault", "",
                "What a contact that is not the ego's fault makes of the session; by_mode: failed "
                "in naturalistic, struck in challenging and safety_critical."},
               contact_without_fault, {"allowed", "struck", "failed", "by_mode"});
  visitor.number({"minimum_driving_score", "%", "Least driving score of the ego."},
                 minimum_driving_score, 0.0, 100.0);
  visitor.number({"minimum_ego_distance", "m", "Least distance that the ego drives."},
                 minimum_ego_distance, 0.0, kInfinite);
  visitor.number({"maximum_ego_collisions", "", "Most contacts of the ego, whosever fault."},
                 maximum_ego_collisions, 0.0, kInfinite);
  visitor.number({"maximum_red_lights", "", "Most red lights that the ego runs."},
                 maximum_red_lights, 0.0, kInfinite);
  visitor.number({"maximum_stop_signs", "", "Most stop signs that the ego does not obey."},
                 maximum_stop_signs, 0.0, kInfinite);
  visitor.number(
      {"maximum_outside_lanes_percent", "%", "Largest share of its route outside the lanes."},
      maximum_outside_lanes_percent, 0.0, 100.0);
  visitor.number({"maximum_cbv_off_road_percent", "%", "Highest off-road rate of the CBVs."},
                 maximum_cbv_off_road_percent, 0.0, 100.0);
  visitor.list({"statuses", "", "Final statuses that pass; empty: all but error and interrupted."},
               statuses);
}

void SimulationOptions::describe(core::OptionsVisitor& visitor) {
  visitor.text({"link", "",
                "SUMO as a process, or in the session's own: faster, without sumo.step_timeout."},
               link, {"libtraci", "libsumo"});
}

void EgoOptions::describe(core::OptionsVisitor& visitor) {
  visitor.text({"command", "", "How an external ego commands (docs/test_your_ego.md)."}, command,
               {"control", "ackermann", "trajectory", "cmd_vel"});
  visitor.number({"object_range", "m", "The ego hears of vehicles up to this distance."},
                 object_range, 1.0, 1000.0);
  visitor.group({"laser", "", "2D laser scanner of the ego."}, laser);
  visitor.group({"lidar", "", "Sparse lidar of the ego."}, lidar);
}

void StoryboardOptions::describe(core::OptionsVisitor& visitor) {
  visitor.text({"file", "", "OpenSCENARIO file (*.xosc); it also gives the ego's route."}, file,
               {});
  visitor.flag({"ignore_unsupported", "", "Go on without elements that are not supported."},
               ignore_unsupported);
}

void ReportOptions::describe(core::OptionsVisitor& visitor) {
  visitor.number({"front_view_rate", "1/s", "Pictures of each CBV's front view in report.html."},
                 front_view_rate, 0.0, 10.0);
}

ScenarioOptions::ScenarioOptions() = default;

void ScenarioOptions::describe(core::OptionsVisitor& visitor) {
  visitor.integer({"schema_version", "", "Version of this format."}, schema_version, 1, 1);
  visitor.text({"name", "", "Name of the scenario in results."}, name, {});
  describeTraffic(visitor);
  describePlanners(visitor);
  visitor.group({"protocol", "", "When a session ends."}, protocol);
  visitor.group({"metrics", "", "What the session is measured against."}, metrics);
  visitor.group({"verdict", "", "Rules by which the session is judged."}, verdict);
  visitor.group({"report", "", "What report.html holds."}, report);
  visitor.groups(
      {"steering", "", "What changes while the session runs, as in [{at: 12, profile: none}]."},
      steering);
  visitor.flag({"video", "", "Also write session.mp4: front view beside the picture from above."},
               video);
  describeTime(visitor);
  visitor.integer({"seed", "", "Root seed of every random draw."}, seed, 0, 2147483647);
}

void ScenarioOptions::describeTraffic(core::OptionsVisitor& visitor) {
  visitor.text(
      {"network", "",
       "Shipped network, or file: SUMO (*.net.xml), OpenDRIVE (*.xodr) or OpenStreetMap (*.osm)."},
      network, {});
  visitor.group({"route", "", "Route of the ego."}, route);
  visitor.group({"storyboard", "", "Vehicles that a story moves."}, storyboard);
  visitor.text({"demand", "", "Background traffic: generated, none, or a route file."}, demand, {});
  visitor.group({"traffic", "", "Generated demand."}, traffic);
  visitor.number({"begin_time", "s", "SUMO's clock at the start, for demand files."}, begin_time,
                 0.0, 1e7);
  visitor.text({"lights", "", "Traffic lights: all green with yielding, or the network's program."},
               lights, {"green", "program"});
}

void ScenarioOptions::describePlanners(core::OptionsVisitor& visitor) {
  visitor.text(
      {"mode", "",
       "How CBVs behave: as in everyday traffic, attacking as a careful driver could still "
       "answer, or seeking a collision."},
      mode, {"naturalistic", "challenging", "safety_critical"});
  visitor.text(
      {"method", "", "Preset of guidance and sampling below all other keys: the paper's, or ours."},
      method, {});
  visitor.text({"ego_planner", "", "Planner of the ego, or external."}, ego_planner, {});
  visitor.joinedTexts({"cbv_planner", "",
                       "Planner of the CBVs, or external; several, by slot, as [a, b] or a+b: "
                       "slot k has the (k mod n)-th."},
                      cbv_planner, '+');
  visitor.integer({"max_cbv", "", "Most CBVs at a time."}, max_cbv, 0, 64);
  visitor.group({"cbv", "", "CBV identification."}, cbv);
  planner_options.describe(visitor);
  visitor.text({"guidance_profile", "",
                "Shipped guidance profile or file; empty: the method's for the mode."},
               guidance_profile, {});
  visitor.group({"guidance", "", "Guidance of the CBVs; defaults are the profile's."}, guidance);
  visitor.text({"ego_guidance_profile", "",
                "Guidance profile of the ego: shipped or file; the mode does not change it."},
               ego_guidance_profile, {});
  visitor.group({"ego_guidance", "", "Guidance of the ego; defaults are its profile's."},
                ego_guidance);
  visitor.group({"camera", "", "Front camera of vehicles whose planner sees."}, camera);
  visitor.group({"ego", "", "Topics of an external ego."}, ego);
  visitor.group({"ego_rig", "", "Cameras of the ego, where its planner sees or it is shown."},
                ego_rig);
  visitor.group({"cbv_rig", "", "Cameras of the CBVs, likewise."}, cbv_rig);
  visitor.group({"vehicle", "", "Dynamics of the vehicles that we drive."}, vehicle);
  visitor.group({"simulation", "", "How the traffic is simulated."}, simulation);
  visitor.group({"sumo", "", "The SUMO process."}, sumo);
}

void ScenarioOptions::describeTime(core::OptionsVisitor& visitor) {
  visitor.number({"target_speed", "m/s", "Speed that planners aim at, capped by the lane's limit."},
                 target_speed, 0.5, 40.0);
  visitor.group({"cbv_target_speed", "", "Target speed of each CBV."}, cbv_target_speed);
  visitor.number({"simulation_step", "s", "Simulation step."}, simulation_step, 0.05, 0.1);
  visitor.number({"decision_period", "s", "Time between decisions."}, decision_period, 0.05, 1.0);
  visitor.number({"real_time_factor", "",
                  "Node graph: the wall clock rules, late answers are replaced; 0 is lockstep."},
                 real_time_factor, 0.0, 100.0);
  visitor.number({"at_most", "", "Lockstep, at most so many times real time; 0 is without limit."},
                 at_most, 0.0, 100.0);
}

void ScenarioOptions::validate() const {
  if (network.empty())
    throw InputError("key 'network' is missing; expected a shipped network or a file");
  if (storyboard.file.empty() || route.given()) route.validate();
  cbv.validate();
  planner_options.validate();
  guidance.validate("guidance.");
  ego_guidance.validate("ego_guidance.");
  cbv_target_speed.validate();
  camera.validate();
  vehicle.validate();
  metrics.validate();
  validateTime();
  planners::requirePlanner("ego_planner", ego_planner, planners::Role::kEgo);
  planners::requirePlanner("cbv_planner", cbv_planner, planners::Role::kCbv);
  validateCameras();
  const bool attacks =
      planners::canBeGuided(cbv_planner) || cbv_planner == planning::kExternalPlanner;
  if (mode != "naturalistic" && !attacks) {
    throw UnfitCombination("key 'mode' is '" + mode +
                           "', which needs a CBV planner with guidance; cbv_planner '" +
                           cbv_planner + "' drives naturalistically only; expected one of " +
                           core::joinText(planners::guidedPlannerNames(), ", "));
  }
  if (hasDemandFile(*this)) {
    if (!core::isFile(demand)) {
      throw InputError("key 'demand' is '" + demand +
                       "'; expected generated, none, or a route file that exists");
    }
    checkDemandFile(demand);
  }
  checkStatuses(verdict.statuses);
  validateSteering(*this);
}

std::string ScenarioOptions::fiercestMode() const {
  std::string fiercest = mode;
  for (const SteeringEntry& entry : steering) {
    const bool fiercer = entry.mode == "safety_critical" || fiercest == "naturalistic";
    if (!entry.mode.empty() && fiercer) fiercest = entry.mode;
  }
  return fiercest;
}

void ScenarioOptions::validateCameras() const {
  ego.laser.validate("ego.laser.");
  ego.lidar.validate("ego.lidar.");
  ego_rig.validate("ego_rig.");
  cbv_rig.validate("cbv_rig.");
  planners::requireRig("ego_planner", ego_planner, {"ego_rig", ego_rig, camera});
  for (const std::string& planner : planners::planningMembers(cbv_planner))
    planners::requireRig("cbv_planner", planner, {"cbv_rig", cbv_rig, camera});
}

void ScenarioOptions::validateTime() const {
  if (!isMultiple(simulation_step, 0.05)) {
    throw InputError("key 'simulation_step' is " + core::formatNumber(simulation_step) +
                     " s; expected a multiple of 0.05 s");
  }
  if (!isMultiple(decision_period, simulation_step)) {
    throw InputError("key 'decision_period' is " + core::formatNumber(decision_period) +
                     " s; expected a multiple of simulation_step (" +
                     core::formatNumber(simulation_step) + " s)");
  }
  if (at_most > 0.0 && real_time_factor > 0.0) {
    throw InputError("keys 'at_most' (" + core::formatNumber(at_most) +
                     ") and 'real_time_factor' (" + core::formatNumber(real_time_factor) +
                     ") are both set; expected one of them: at_most waits for every answer, "
                     "real_time_factor replaces late ones");
  }
}

namespace {

fs::path scenarioFolder() { return core::shareFolder() / "config" / "scenarios"; }

bool looksLikeFile(const std::string& text) {
  return text.find('/') != std::string::npos || text.find('.') != std::string::npos;
}

/// A file named in a scenario: beside the scenario file, else beside its network, else as given.
std::string resolveFile(const std::string& file, const fs::path& scenario_folder,
                        const std::string& network) {
  if (file.empty() || fs::path(file).is_absolute()) return file;
  const fs::path candidates[] = {scenario_folder / file,
                                 core::shareFolder() / "networks" / network / file,
                                 fs::path(network).parent_path() / file};
  for (const fs::path& candidate : candidates) {
    if (core::isFile(candidate)) return fs::weakly_canonical(candidate).string();
  }
  return file;
}

}  // namespace

ScenarioOptions loadScenario(const std::string& name_or_file, const ScenarioOptions& base) {
  const fs::path file = core::shippedOrFile(scenarioFolder(), name_or_file, "scenario");
  ScenarioOptions options = base;
  options.name = file.stem().string();
  core::loadOptions({file.string(), core::readFile(file, "scenario", core::kLargestOptionsFile)},
                    options);
  const bool file_network = looksLikeFile(options.network);
  if (file_network) options.network = resolveFile(options.network, file.parent_path(), "");
  if (hasDemandFile(options)) {
    options.demand = resolveFile(options.demand, file.parent_path(), options.network);
  }
  options.metrics.speed_target_file =
      resolveFile(options.metrics.speed_target_file, file.parent_path(), options.network);
  options.storyboard.file =
      resolveFile(options.storyboard.file, file.parent_path(), options.network);
  options.route.bench2drive_file =
      resolveFile(options.route.bench2drive_file, file.parent_path(), options.network);
  return options;
}

std::vector<std::string> shippedScenarios() { return core::shippedNames(scenarioFolder()); }

}  // namespace cdiff::session
