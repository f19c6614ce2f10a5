// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "session/session_request.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/file.h"
#include "core/json_file.h"
#include "core/option_fields.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "planning/plan_tracker.h"
#include "session/preset_file.h"
#include "session/storyboard_scenario.h"

namespace cdiff::session {
namespace {

namespace fs = std::filesystem;

fs::path methodFolder() { return core::shareFolder() / "config" / "methods"; }

}  // namespace

void MethodOptions::describe(core::OptionsVisitor& visitor) {
  visitor.text({"naturalistic_profile", "", "Guidance profile of CBVs in mode naturalistic."},
               naturalistic_profile, {});
  visitor.text({"challenging_profile", "", "Guidance profile of CBVs in mode challenging."},
               challenging_profile, {});
  visitor.text({"safety_critical_profile", "", "Guidance profile of CBVs in mode safety_critical."},
               safety_critical_profile, {});
  visitor.text({"ego_profile", "", "Guidance profile of the ego."}, ego_profile, {});
  planner_options.describe(visitor);
}

const std::string& MethodOptions::profileOf(const std::string& mode) const {
  if (mode == "challenging") return challenging_profile;
  return mode == "safety_critical" ? safety_critical_profile : naturalistic_profile;
}

MethodOptions loadMethod(const std::string& name) {
  return loadPreset<MethodOptions>(methodFolder(), name,
                                   "key 'method' is '" + name + "', an unknown method");
}

std::vector<std::string> shippedMethods() { return core::shippedNames(methodFolder()); }

namespace {

using FlatValues = std::map<std::string, std::string>;

/// Keys of `values` that have another value in `preset`.
std::vector<std::string> changedKeys(const FlatValues& preset, const FlatValues& values) {
  std::vector<std::string> changed;
  for (const auto& [key, value] : values) {
    const auto other = preset.find(key);
    if (other == preset.end() || other->second != value) changed.push_back(key);
  }
  return changed;
}

bool hasNetwork(const std::string& planner) {
  const planning::PlannerDescriptor* descriptor = planners::findPlanner(planner);
  return descriptor != nullptr && descriptor->network;
}

/// Options of the planners with a network, which are what a method sets.
void addPlannerChanges(const MethodOptions& method, const ScenarioOptions& scenario,
                       std::vector<std::string>& changed) {
  for (const std::string& key : changedKeys(core::flatOptions(method.planner_options),
                                            core::flatOptions(scenario.planner_options))) {
    if (hasNetwork(key.substr(0, key.find('.')))) changed.push_back(key);
  }
}

/// Guidance under `group` that is not as the method's profile has it: by the name of another
/// profile where one was given, else by its keys.
void addGuidanceChanges(const std::string& group, const guidance::GuidanceOptions& guidance,
                        const std::string& given, const std::string& profile,
                        std::vector<std::string>& changed) {
  const auto keys =
      changedKeys(core::flatOptions(guidance::loadProfile(profile)), core::flatOptions(guidance));
  if (!keys.empty() && !given.empty() && given != profile) {
    changed.push_back(group + "_profile");
    return;
  }
  for (const std::string& key : keys) changed.push_back(group + "." + key);
}

}  // namespace

MethodUse methodOf(const ScenarioOptions& scenario) {
  MethodUse use{scenario.method, scenario.method, {}};
  const std::vector<std::string> known = shippedMethods();
  if (std::find(known.begin(), known.end(), scenario.method) == known.end()) {
    use.changed.emplace_back("method");  // a recording's, which is no longer shipped
  } else if (hasNetwork(scenario.ego_planner) || hasNetwork(scenario.cbv_planner)) {
    const MethodOptions method = loadMethod(scenario.method);
    addPlannerChanges(method, scenario, use.changed);
    if (planners::canBeGuided(scenario.cbv_planner))
      addGuidanceChanges("guidance", scenario.guidance, scenario.guidance_profile,
                         method.profileOf(scenario.mode), use.changed);
    if (planners::canBeGuided(scenario.ego_planner))
      addGuidanceChanges("ego_guidance", scenario.ego_guidance, scenario.ego_guidance_profile,
                         method.ego_profile, use.changed);
  }
  if (!use.changed.empty()) use.name = kCustomMethod;
  return use;
}

std::string methodText(const MethodUse& method) {
  constexpr std::size_t kShown = 3;
  if (method.changed.empty()) return method.name;
  std::vector<std::string> shown = method.changed;
  const std::size_t more = shown.size() > kShown ? shown.size() - kShown : 0;
  shown.resize(shown.size() - more);
  return method.name + " (" + method.preset + " but for " + core::joinText(shown, ", ") +
         (more == 0 ? "" : " and " + std::to_string(more) + " more keys") + ")";
}

namespace {

using core::InputError;
using nlohmann::json;

constexpr std::size_t kMostSamples = 250000;  // a resolved scenario holds them all
constexpr const char* kBlank = " \t\r\n";

std::string trimmed(const std::string& text) {
  const auto begin = text.find_first_not_of(kBlank);
  if (begin == std::string::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlank) - begin + 1);
}

std::vector<double> fromLines(const std::string& text, const std::string& file) {
  std::vector<double> samples;
  std::stringstream stream(text);
  std::size_t number = 0;
  for (std::string line; std::getline(stream, line);) {
    ++number;
    const std::string content = trimmed(line.substr(0, line.find('#')));
    if (content.empty()) continue;
    const auto value = core::parseNumber(content);
    if (!value) {
      throw InputError(file + ":" + std::to_string(number) + ": \"" + content +
                       "\", expected one finite number a line");
    }
    samples.push_back(*value);
  }
  return samples;
}

std::vector<double> fromCase(const json& entry, const std::string& place) {
  const auto found = entry.is_object() ? entry.find("x") : entry.end();
  if (found == entry.end() || !found->is_array())
    throw InputError(place + ": expected a list \"x\" of numbers");
  std::vector<double> samples;
  for (const json& value : *found) {
    if (!value.is_number()) {
      throw InputError(place + ": \"x\" holds " + value.dump() + ", expected numbers");
    }
    samples.push_back(value.get<double>());
  }
  return samples;
}

std::vector<double> fromJson(const std::string& text, const std::string& file) {
  json document;
  try {
    core::requireShallowJson(text, file);
    document = json::parse(text);
  } catch (const json::exception& error) {
    throw InputError(file + ": not JSON: " + core::jsonFault(error));
  }
  const auto cases = document.find("cases");
  if (cases == document.end() || !cases->is_array())
    throw InputError(file + ": expected an object with a list \"cases\"");
  std::vector<double> samples;
  for (std::size_t i = 0; i < cases->size(); ++i) {
    const auto more = fromCase((*cases)[i], file + ": case " + std::to_string(i + 1));
    samples.insert(samples.end(), more.begin(), more.end());
  }
  return samples;
}

}  // namespace

std::vector<double> readSamples(const std::filesystem::path& file) {
  const std::string text = core::readFile(file, "file of samples");
  const auto first = text.find_first_not_of(kBlank);
  const bool is_json = first != std::string::npos && text[first] == '{';
  const std::vector<double> samples =
      is_json ? fromJson(text, file.string()) : fromLines(text, file.string());
  if (samples.empty()) throw InputError(file.string() + ": holds no sample");
  if (samples.size() > kMostSamples) {
    throw InputError(file.string() + ": holds " + std::to_string(samples.size()) +
                     " samples; at most " + std::to_string(kMostSamples) +
                     " were expected, every n-th will do");
  }
  return samples;
}

namespace {

constexpr const char* kBenchmarkProtocol = "rift_dev10";  ///< of Bench2Drive's routes

/// A scenario made of a Bench2Drive route alone, with generated demand and the standard rules.
ScenarioOptions bench2DriveScenario(const SessionRequest& request, const ScenarioOptions& base) {
  if (request.route.empty())
    throw InputError("a Bench2Drive file needs the id of a route (--route ID)");
  if (request.network.empty()) {
    throw InputError("route " + request.route + " lies in " +
                     map::bench2DriveTown(request.bench2drive, request.route) +
                     "; give that town's network (--network NET.net.xml)");
  }
  ScenarioOptions options = base;
  options.name = "bench2drive_" + request.route;
  options.verdict = VerdictOptions::standard();
  if (options.protocol.preset == kUsualProtocol) options.protocol.preset = kBenchmarkProtocol;
  options.route.bench2drive_file = fs::absolute(request.bench2drive).string();
  options.route.bench2drive_id = request.route;
  return options;
}

ScenarioOptions baseScenario(const SessionRequest& request, const ScenarioOptions& base) {
  const bool bench2drive = !request.bench2drive.empty();
  if (bench2drive && !request.scenario.empty()) {
    throw InputError("give either a scenario or a Bench2Drive file, not both ('" +
                     request.scenario + "' and '" + request.bench2drive + "')");
  }
  if (bench2drive) return bench2DriveScenario(request, base);
  if (!request.route.empty())
    throw InputError("--route " + request.route + " needs --bench2drive FILE");
  if (request.scenario.empty()) {
    throw InputError(
        "nothing to run: give a scenario (name or file), or --bench2drive FILE --route ID "
        "--network NET");
  }
  if (isOpenScenario(request.scenario)) {
    return openScenarioOptions(request.scenario, base, request.network.empty());
  }
  return loadScenario(request.scenario, base);
}

/// `base` with the scenario's keys and then the request's on top.
ScenarioOptions applyRequest(const SessionRequest& request, const ScenarioOptions& base) {
  ScenarioOptions options = baseScenario(request, base);
  if (!request.network.empty()) {
    options.network =
        core::isFile(request.network) ? fs::absolute(request.network).string() : request.network;
  }
  const auto apply = [&](const std::string& key, const std::string& value) {
    if (!value.empty()) core::overrideOption(key + "=" + value, "argument '" + key + "'", options);
  };
  apply("mode", request.mode);
  apply("ego_planner", request.ego_planner);
  apply("cbv_planner", request.cbv_planner);
  apply("seed", request.seed);
  if (request.video) options.video = true;
  if (request.ignore_unsupported) options.storyboard.ignore_unsupported = true;
  if (request.steering) options.steering = *request.steering;
  for (const std::string& assignment : request.set)
    core::overrideOption(assignment, request.set_source, options);
  return options;
}

guidance::GuidanceOptions profileOf(const std::string& key, const std::string& name) {
  try {
    return guidance::loadProfile(name);
  } catch (const InputError& error) {
    throw InputError("key '" + key + "': " + error.what());
  }
}

/// The content of the file that speeds are compared with, so that a recording needs no file.
void fillSpeedTarget(metrics::MetricsOptions& options) {
  if (options.speed_target != "file" || options.speed_target_file.empty() ||
      !options.speed_target_samples.empty()) {
    return;
  }
  for (const double speed : readSamples(options.speed_target_file))
    options.speed_target_samples.push_back(core::formatNumber(speed));
}

/// What lies below the keys of a scenario before the scenario's own choice of presets is known.
ScenarioOptions unchosenBase(const MethodOptions& method) {
  ScenarioOptions base;
  base.planner_options = method.planner_options;
  base.ego_guidance_profile = method.ego_profile;
  base.protocol.preset = kUsualProtocol;
  return base;
}

/// Gives `base` the values of the presets that the scenario `first` names.
void addPresets(const ScenarioOptions& first, const MethodOptions& method, ScenarioOptions& base) {
  const bool named = !first.guidance_profile.empty();
  base.guidance =
      profileOf("guidance_profile", named ? first.guidance_profile : method.profileOf(first.mode));
  base.ego_guidance = profileOf("ego_guidance_profile", first.ego_guidance_profile);
  base.protocol = loadProtocol(first.protocol.preset);
  planning::nameTrackers(first.planner_options, base.planner_options);
}

/// A time limit that the user gives holds as given: it grows only where its growth is given, too.
void fixTimeLimit(const SessionRequest& request, ScenarioOptions base, ScenarioOptions& options) {
  if (options.protocol.time_limit_speed_percent <= 0.0) return;
  // What was given is the same on top of any other base.
  base.protocol.time_limit += 1.0;
  base.protocol.time_limit_speed_percent += 1.0;
  const ProtocolOptions other = applyRequest(request, base).protocol;
  const ProtocolOptions& protocol = options.protocol;
  if (other.time_limit == protocol.time_limit &&
      other.time_limit_speed_percent != protocol.time_limit_speed_percent)
    options.protocol.time_limit_speed_percent = 0.0;
}

}  // namespace

ScenarioOptions defaultScenario() {
  const MethodOptions method = loadMethod(ScenarioOptions().method);
  ScenarioOptions options = unchosenBase(method);
  addPresets(options, method, options);
  return options;
}

ScenarioOptions resolveRequest(const SessionRequest& request) {
  // Which method, profile, protocol and trackers apply is only known when everything was read;
  // their values then lie below everything else.
  const MethodOptions method = loadMethod(applyRequest(request, {}).method);
  ScenarioOptions base = unchosenBase(method);
  addPresets(applyRequest(request, base), method, base);
  ScenarioOptions options = applyRequest(request, base);
  fixTimeLimit(request, base, options);
  fillSpeedTarget(options.metrics);
  options.validate();
  return options;
}

}  // namespace cdiff::session
