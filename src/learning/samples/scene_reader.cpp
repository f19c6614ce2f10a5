// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <stdexcept>

#include "learning/samples/scene_tables.h"

namespace cdiff::learning {
namespace {

using SceneBytes = std::vector<std::uint8_t>;
using SceneCounts = std::vector<std::uint64_t>;
using SceneNumbers = std::vector<double>;

std::string textOfBytes(const SceneBytes& bytes) { return std::string(bytes.begin(), bytes.end()); }

/// Texts of a list, each closed by a zero byte.
std::vector<std::string> listOf(const SceneBytes& bytes) {
  std::vector<std::string> texts;
  std::string text;
  for (const std::uint8_t byte : bytes) {
    if (byte != 0) {
      text.push_back(static_cast<char>(byte));
      continue;
    }
    texts.push_back(text);
    text.clear();
  }
  return texts;
}

/// Reads the vehicles of all decisions from the columns of the tables, row by row.
class VehicleRows {
 public:
  VehicleRows(const Sample& tables, const std::vector<std::string>& lanes)
      : ids_(listOf(tables.get<SceneBytes>("vehicle_ids"))),
        lanes_(lanes),
        sizes_(tables.get<SceneNumbers>("dimensions")),
        vehicle_(tables.get<SceneCounts>("vehicle")),
        lane_(tables.get<SceneCounts>("lane")),
        role_(tables.get<SceneBytes>("role")),
        slot_(tables.get<SceneBytes>("slot")),
        has_action_(tables.get<SceneBytes>("has_action")) {
    for (const StateColumn& column : stateColumns())
      numbers_.push_back(&tables.get<SceneNumbers>(column.name));
  }

  const std::vector<std::string>& ids() const { return ids_; }

  traffic::Vehicle next() {
    const std::size_t row = row_++;
    const std::uint64_t index = vehicle_.at(row);
    if (role_.at(row) > static_cast<std::uint8_t>(traffic::VehicleRole::kBackground))
      throw std::out_of_range("role");
    traffic::Vehicle vehicle;
    vehicle.id = ids_.at(index);
    vehicle.dimensions = {sizes_.at(3 * index), sizes_.at(3 * index + 1), sizes_.at(3 * index + 2)};
    vehicle.role = static_cast<traffic::VehicleRole>(role_[row]);
    vehicle.cbv_slot = static_cast<int>(slot_.at(row)) - 1;
    vehicle.lane_id = lanes_.at(lane_.at(row));
    if (has_action_.at(row) != 0) vehicle.applied_action.emplace();
    for (std::size_t i = 0; i < numbers_.size(); ++i)
      stateColumns()[i].set(vehicle, numbers_[i]->at(row));
    return vehicle;
  }

 private:
  std::vector<std::string> ids_;
  const std::vector<std::string>& lanes_;
  const SceneNumbers& sizes_;   ///< length, width, height of each vehicle [m]
  const SceneCounts& vehicle_;  ///< by row: index in ids_
  const SceneCounts& lane_;     ///< by row: index in lanes_
  const SceneBytes& role_;
  const SceneBytes& slot_;  ///< by row: slot + 1
  const SceneBytes& has_action_;
  std::vector<const SceneNumbers*> numbers_;  ///< by state column
  std::size_t row_ = 0;
};

/// Reads the tables of one scene (scene_tables.h), the counterpart of scene_writer.cpp; a column
/// that is too short throws std::out_of_range.
class TableReader {
 public:
  explicit TableReader(const Sample& tables)
      : tables_(tables), lanes_(listOf(bytes("lane_ids"))), rows_(tables, lanes_) {}

  Scene read() {
    Scene scene;
    scene.name = text("name");
    scene.scenario_yaml = text("scenario");
    scene.network_source = text("network_source");
    scene.network_source_sha256 = text("network_source_sha256");
    scene.network_text = text("network");
    readDecisions(scene);
    readSignals(scene);
    readDrives(scene);
    readLists(scene);
    scene.seconds = numbers("seconds").at(0);
    return scene;
  }

 private:
  const SceneBytes& bytes(const char* name) const { return tables_.get<SceneBytes>(name); }
  const SceneCounts& counts(const char* name) const { return tables_.get<SceneCounts>(name); }
  const SceneNumbers& numbers(const char* name) const { return tables_.get<SceneNumbers>(name); }
  std::string text(const char* name) const { return textOfBytes(bytes(name)); }

  void readDecisions(Scene& scene) {
    const SceneCounts& ticks = counts("tick");
    for (std::size_t i = 0; i < ticks.size(); ++i) {
      traffic::TrafficSnapshot& snapshot = scene.decisions.emplace_back();
      snapshot.tick = ticks[i];
      snapshot.time = numbers("time").at(i);
      snapshot.decision_tick = true;
      for (std::uint64_t n = counts("vehicles").at(i); n > 0; --n)
        snapshot.vehicles.push_back(rows_.next());
    }
  }

  /// A signal is a pair of texts: its index in the list of signals, and its state.
  void readSignals(Scene& scene) const {
    const std::vector<std::string> ids = listOf(bytes("signal_ids"));
    const std::vector<std::string> states = listOf(bytes("signal_states"));
    std::size_t next = 0;
    for (std::size_t i = 0; i < scene.decisions.size(); ++i) {
      for (std::uint64_t n = counts("signals").at(i); n > 0; --n, next += 2) {
        const std::string& index = states.at(next);
        if (index.empty() || index.size() > 9 ||
            index.find_first_not_of("0123456789") != std::string::npos)
          throw std::out_of_range("signal");
        scene.decisions[i].signals.push_back({ids.at(std::stoull(index)), states.at(next + 1)});
      }
    }
  }

  void readDrives(Scene& scene) const {
    const SceneCounts& vehicles = counts("drive_vehicle");
    const SceneNumbers& route = numbers("route");
    const SceneCounts& lanes = counts("route_lane");
    std::size_t point = 0;
    for (std::size_t i = 0; i < vehicles.size(); ++i) {
      SceneDrive& drive = scene.drives.emplace_back();
      drive.vehicle_id = rows_.ids().at(vehicles[i]);
      drive.selected_tick = counts("drive_tick").at(i);
      setDriver(i, drive);
      for (std::uint64_t n = counts("route_size").at(i); n > 0; --n, ++point) {
        drive.route_lanes.push_back(lanes_.at(lanes.at(point)));
        drive.route_points.emplace_back(route.at(3 * point), route.at(3 * point + 1),
                                        route.at(3 * point + 2));
      }
    }
  }

  /// Driver [SI units], score and conflict point (map frame [m]) of drive i.
  void setDriver(std::size_t i, SceneDrive& drive) const {
    const SceneNumbers& all = numbers("driver");
    const auto number = [&](std::size_t n) { return all.at(kDriverNumbers * i + n); };
    drive.driver = {number(0), number(1), number(2), number(3), number(4)};
    drive.interaction_score = number(5);
    drive.conflict_point = {number(6), number(7), number(8)};
  }

  /// Rows of driven (decision, slot + 1, drive), disturbed (tick, vehicle) and contacts (tick, two
  /// vehicles).
  void readLists(Scene& scene) const {
    const std::vector<std::string>& ids = rows_.ids();
    scene.driven.resize(scene.decisions.size());
    const SceneCounts& driven = counts("driven");
    for (std::size_t i = 0; i < driven.size(); i += 3) {
      if (driven.at(i + 2) >= scene.drives.size()) throw std::out_of_range("drive");
      scene.driven.at(driven[i])[static_cast<int>(driven.at(i + 1)) - 1] = driven.at(i + 2);
    }
    const SceneCounts& disturbed = counts("disturbed");
    for (std::size_t i = 0; i < disturbed.size(); i += 2)
      scene.disturbed.insert({ids.at(disturbed.at(i + 1)), disturbed[i]});
    const SceneCounts& contacts = counts("contacts");
    for (std::size_t i = 0; i < contacts.size(); i += 3)
      scene.contacts.push_back(
          {contacts[i], {ids.at(contacts.at(i + 1)), ids.at(contacts.at(i + 2))}});
  }

  const Sample& tables_;
  std::vector<std::string> lanes_;
  VehicleRows rows_;
};

}  // namespace

Scene sceneOfTables(const Sample& tables) { return TableReader(tables).read(); }

}  // namespace cdiff::learning
