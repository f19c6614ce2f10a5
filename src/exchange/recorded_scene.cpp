// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "exchange/recorded_scene.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <unordered_map>

#include "core/file.h"
#include "core/json_file.h"
#include "core/text.h"
#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/core/exceptions.h"
#include "record/logs/size_log.h"
#include "record/result_folder.h"
#include "record/session_yaml.h"
#include "traffic/vehicle_class.h"

namespace cdiff::exchange {
namespace {

namespace fs = std::filesystem;
using core::InputError;
using traffic::VehicleRole;

/// A vehicle counts as near when its center comes within this distance of the ego's [m].
constexpr double kNear = 50.0;

/// What --vehicles asks for.
struct Choice {
  explicit Choice(const std::string& text) {
    for (const std::string& word : core::splitText(text, ',')) words.insert(word);
  }
  bool has(const char* word) const { return words.count(word) > 0 || words.count("all") > 0; }
  std::set<std::string> words;
};

/// First and last tick of the part that is exported.
struct Window {
  std::uint64_t first = 0;
  std::uint64_t last = 0;
  bool holds(std::uint64_t tick) const { return tick >= first && tick <= last; }
};

Window windowOf(const std::vector<record::TraceRow>& rows, const SceneOptions& options, double step,
                const fs::path& file) {
  std::uint64_t end = 0;
  for (const record::TraceRow& row : rows) end = std::max(end, row.tick);
  const double length = static_cast<double>(end) * step;
  const double last = options.to.value_or(length);
  if (options.from >= length || last > length + 0.5 * step) {
    throw InputError("'" + file.string() + "' lasts " + core::formatNumber(length) +
                     " s; --from must be before that, and --to at most that");
  }
  const Window window{static_cast<std::uint64_t>(std::llround(options.from / step)),
                      static_cast<std::uint64_t>(std::llround(last / step))};
  if (window.first < window.last) return window;
  throw InputError("--from " + core::formatNumber(options.from) + " --to " +
                   core::formatNumber(last) + ": shorter than a tick; expected at least " +
                   core::formatNumber(step) + " s");
}

/// Courses of all vehicles within the window, without elevation.
std::vector<SceneVehicle> coursesOf(const std::vector<record::TraceRow>& rows,
                                    const Window& window) {
  std::vector<SceneVehicle> vehicles;
  std::unordered_map<std::string, std::size_t> index;
  for (const record::TraceRow& row : rows) {
    if (!window.holds(row.tick)) continue;
    const auto [place, added] = index.emplace(row.id, vehicles.size());
    if (added) vehicles.push_back({row.id, row.role, {}, {}});
    SceneVehicle& vehicle = vehicles[place->second];
    if (row.role == VehicleRole::kCbv) vehicle.role = VehicleRole::kCbv;
    double heading = row.heading;
    if (!vehicle.states.empty()) {
      const double before = vehicle.states.back().pose.heading;
      heading = before + core::angleDifference(row.heading, before);
    }
    vehicle.states.push_back({row.tick - window.first, {row.position, 0.0, heading, row.speed}});
  }
  return vehicles;
}

bool comesNear(const SceneVehicle& ego, const SceneVehicle& vehicle) {
  std::size_t at = 0;  // of the ego's states, which are one a tick
  for (const SceneState& state : vehicle.states) {
    while (at < ego.states.size() && ego.states[at].step < state.step) ++at;
    if (at == ego.states.size()) return false;
    if (ego.states[at].step != state.step) continue;
    if ((ego.states[at].pose.position - state.pose.position).norm() <= kNear) return true;
  }
  return false;
}

/// Keeps the vehicles that are asked for.
void keepChosen(std::vector<SceneVehicle>& vehicles, const Choice& choice) {
  const auto ego = std::find_if(vehicles.begin(), vehicles.end(), [](const SceneVehicle& vehicle) {
    return vehicle.role == VehicleRole::kEgo;
  });
  const std::optional<SceneVehicle> reference =
      ego == vehicles.end() ? std::nullopt : std::optional<SceneVehicle>(*ego);
  const auto chosen = [&](const SceneVehicle& vehicle) {
    if (choice.words.count("all") > 0) return true;
    if (vehicle.role == VehicleRole::kEgo) return choice.has("ego");
    if (vehicle.role == VehicleRole::kCbv && choice.has("cbv")) return true;
    return choice.has("near") && reference && comesNear(*reference, vehicle);
  };
  vehicles.erase(std::remove_if(vehicles.begin(), vehicles.end(),
                                [&](const SceneVehicle& vehicle) { return !chosen(vehicle); }),
                 vehicles.end());
}

/// Elevation of the lane below each state: of several, the one nearest to the elevation before.
void addElevation(const map::RoadNetwork& network, SceneVehicle& vehicle) {
  constexpr double kReach = 10.0;  // [m]
  std::optional<double> before;
  for (SceneState& state : vehicle.states) {
    const auto lanes = network.lanesNear(state.pose.position, kReach);
    const auto rise = [&](const map::LaneMatch& lane) {
      return std::abs(lane.projection.elevation - *before);
    };
    auto lane = lanes.begin();
    if (before) {
      lane = std::min_element(
          lanes.begin(), lanes.end(),
          [&](const auto& first, const auto& other) { return rise(first) < rise(other); });
    }
    if (lane != lanes.end()) before = lane->projection.elevation;
    state.pose.elevation = before.value_or(0.0);
  }
}

bool isFlat(const map::RoadNetwork& network) {
  return std::all_of(network.lanes().begin(), network.lanes().end(), [](const map::Lane& lane) {
    const auto& points = lane.centerline.points();
    return std::all_of(points.begin(), points.end(),
                       [](const Eigen::Vector3d& point) { return point.z() == 0.0; });
  });
}

void addElevations(const map::ImportedNetwork& import, std::vector<SceneVehicle>& vehicles) {
  const auto network = map::RoadNetwork::fromText(import.text, import.source.string());
  if (isFlat(network)) return;
  for (SceneVehicle& vehicle : vehicles) addElevation(network, vehicle);
}

/// Gives each vehicle its size; whether the result says it.
bool addSizes(const fs::path& folder, std::vector<SceneVehicle>& vehicles) {
  const fs::path file = folder / "vehicles.csv";
  if (!core::isFile(file)) return false;
  const record::SizesById sizes = record::readSizes(file);
  for (SceneVehicle& vehicle : vehicles) {
    const auto size = sizes.find(vehicle.id);
    if (size == sizes.end())
      throw InputError("'" + file.string() + "' lacks the vehicle '" + vehicle.id +
                       "' of trace.csv");
    vehicle.dimensions = size->second;
  }
  return true;
}

/// The network that the session had. Throws InputError when it is another by now.
map::ImportedNetwork networkOf(const record::SessionFile& session, const fs::path& file) {
  map::ImportedNetwork import = map::importNetwork(session.scenario.network);
  const auto fact = session.facts.find("network.imported_sha256");
  const std::string now = "\"" + core::sha256(import.text) + "\"";
  if (fact != session.facts.end() && fact->second != now) {
    throw InputError(file.string() + ": key 'network.imported_sha256' is " + fact->second +
                     ", but the network '" + import.source.string() + "' has " + now +
                     " now; put back what the session ran with");
  }
  return import;
}

void takeContact(const nlohmann::json& summary, SceneFacts& facts) {
  for (const auto& contact : summary.at("ego").at("contacts")) {
    const bool with_cbv = contact.value("with_cbv", false);
    if (facts.contact_seconds && !with_cbv) continue;
    facts.contact_seconds = contact.at("seconds").get<double>();
    facts.contact_with = contact.at("with");
    facts.contact_with_cbv = with_cbv;
    if (with_cbv) return;
  }
}

}  // namespace

const char* vehicleWord(const traffic::VehicleDimensions& size) {
  switch (traffic::classOf(size)) {
    case traffic::VehicleClass::kNarrow:
      return "bicycle";
    case traffic::VehicleClass::kLarge:
      return "truck";
    case traffic::VehicleClass::kCar:
      break;
  }
  return "car";
}

void SceneOptions::validate() const {
  if (!(from >= 0.0) || (to && !(*to > from))) {
    throw InputError("--from " + core::formatNumber(from) +
                     (to ? " --to " + core::formatNumber(*to) : "") +
                     ": expected 0 <= from < to [s]");
  }
  const Choice choice(vehicles);
  const std::set<std::string> known = {"ego", "cbv", "near", "all"};
  for (const std::string& word : choice.words) {
    if (known.count(word) == 0 || (word == "all" && choice.words.size() > 1))
      throw InputError("--vehicles " + vehicles +
                       ": expected 'all', or some of ego, cbv, near with commas between");
  }
  if (choice.words.empty()) throw InputError("--vehicles is empty; expected ego, cbv, near or all");
}

SceneFacts readFacts(const fs::path& folder) {
  const std::string file = (folder / "summary.json").string();
  try {
    const auto summary = core::readJson(file, "summary");
    SceneFacts facts;
    facts.scenario = summary.at("scenario");
    facts.seed = summary.at("seed");
    facts.mode = summary.at("mode");
    facts.method = summary.at("method");
    facts.ego_planner = summary.at("ego_planner");
    facts.cbv_planner = summary.at("cbv_planner");
    facts.status = summary.at("status");
    facts.verdict = summary.at("verdict").at("outcome");
    facts.trace_sha256 = summary.at("trace_sha256");
    takeContact(summary, facts);
    return facts;
  } catch (const nlohmann::json::exception& error) {
    throw InputError("'" + file + "' is no summary of a session: " + core::jsonFault(error) +
                     "; expected the result of a session of this version");
  }
}

RecordedScene readScene(const fs::path& folder, const SceneOptions& options) {
  options.validate();
  const fs::path file = folder / "session.yaml";
  const fs::path trace = folder / "trace.csv";
  const record::SessionFile session = record::readSessionYaml(file);
  RecordedScene scene;
  scene.facts = readFacts(folder);
  if (core::sha256(core::readFile(trace, "trace")) != scene.facts.trace_sha256) {
    throw InputError("'" + trace.string() +
                     "' is not the trace that summary.json names (trace_sha256); give a result "
                     "folder as the session left it");
  }
  const std::vector<record::TraceRow> rows = record::readTrace(trace);
  scene.step = session.scenario.simulation_step;
  const Window window = windowOf(rows, options, scene.step, trace);
  scene.steps = window.last - window.first;
  scene.import = networkOf(session, file);
  scene.vehicles = coursesOf(rows, window);
  keepChosen(scene.vehicles, Choice(options.vehicles));
  scene.sizes_known = addSizes(folder, scene.vehicles);
  addElevations(scene.import, scene.vehicles);
  return scene;
}

}  // namespace cdiff::exchange
