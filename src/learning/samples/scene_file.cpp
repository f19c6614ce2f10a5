// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "learning/samples/scene_file.h"

#include <stdexcept>
#include <string_view>
#include <unordered_map>

#include "learning/samples/scene_tables.h"
#include "traffic/vehicle_class.h"

namespace cdiff::learning {
namespace {

using Bytes = std::vector<std::uint8_t>;
using Counts = std::vector<std::uint64_t>;
using Numbers = std::vector<double>;
using traffic::Vehicle;

Bytes bytesOfText(std::string_view text) { return Bytes(text.begin(), text.end()); }

/// Texts in the order in which they came first, each with its place.
class TextList {
 public:
  std::uint64_t placeOf(const std::string& text) {
    const auto [entry, added] = places_.emplace(text, places_.size());
    if (added) joined_.append(text).push_back('\0');
    return entry->second;
  }
  std::size_t size() const { return places_.size(); }
  Bytes bytes() const { return bytesOfText(joined_); }

 private:
  std::unordered_map<std::string, std::uint64_t> places_;
  std::string joined_;
};

/// Fills the tables of one scene.
class TableWriter {
 public:
  Sample write(const Scene& scene) {
    for (const FieldSpec& spec : sceneSchema().fields) addEmpty(spec);
    text("name", scene.name);
    text("scenario", scene.scenario_yaml);
    text("network_source", scene.network_source);
    text("network_source_sha256", scene.network_source_sha256);
    text("network", scene.network_text);
    for (const traffic::TrafficSnapshot& snapshot : scene.decisions) addDecision(snapshot);
    for (const SceneDrive& drive : scene.drives) addDrive(drive);
    addLists(scene);
    bytes("vehicle_ids") = vehicles_.bytes();
    bytes("lane_ids") = lanes_.bytes();
    bytes("signal_ids") = signals_.bytes();
    numbers("seconds") = {scene.seconds};
    return std::move(tables_);
  }

 private:
  void addEmpty(const FieldSpec& spec) {
    FieldValue& value = tables_.fields[spec.name];
    if (spec.type == FieldType::kU8) value = Bytes();
    if (spec.type == FieldType::kU64) value = Counts();
    if (spec.type == FieldType::kF64) value = Numbers();
  }
  Bytes& bytes(const char* name) { return std::get<Bytes>(tables_.fields.at(name)); }
  Counts& counts(const char* name) { return std::get<Counts>(tables_.fields.at(name)); }
  Numbers& numbers(const char* name) { return std::get<Numbers>(tables_.fields.at(name)); }
  void text(const char* name, const std::string& content) { bytes(name) = bytesOfText(content); }

  std::uint64_t vehicle(const std::string& id, const traffic::VehicleDimensions& size) {
    const std::size_t before = vehicles_.size();
    const std::uint64_t place = vehicles_.placeOf(id);
    if (vehicles_.size() == before) return place;
    for (const double number : {size.length, size.width, size.height})
      numbers("dimensions").push_back(number);
    bytes("class").push_back(static_cast<std::uint8_t>(traffic::classOf(size)));
    return place;
  }

  void addDecision(const traffic::TrafficSnapshot& snapshot) {
    counts("tick").push_back(snapshot.tick);
    numbers("time").push_back(snapshot.time);
    counts("vehicles").push_back(snapshot.vehicles.size());
    counts("signals").push_back(snapshot.signals.size());
    for (const Vehicle& vehicle : snapshot.vehicles) addVehicle(vehicle);
    for (const traffic::SignalState& signal : snapshot.signals) {
      Bytes& states = bytes("signal_states");
      for (const std::string& part : {std::to_string(signals_.placeOf(signal.id)), signal.state}) {
        states.insert(states.end(), part.begin(), part.end());
        states.push_back(0);
      }
    }
  }

  void addVehicle(const Vehicle& one) {
    counts("vehicle").push_back(vehicle(one.id, one.dimensions));
    counts("lane").push_back(lanes_.placeOf(one.lane_id));
    bytes("role").push_back(static_cast<std::uint8_t>(one.role));
    bytes("slot").push_back(static_cast<std::uint8_t>(one.cbv_slot + 1));
    bytes("has_action").push_back(one.applied_action.has_value() ? 1 : 0);
    for (const StateColumn& column : stateColumns())
      numbers(column.name).push_back(column.get(one));
  }

  void addDrive(const SceneDrive& drive) {
    const SceneDriver& driver = drive.driver;
    counts("drive_vehicle").push_back(known(drive.vehicle_id));
    counts("drive_tick").push_back(drive.selected_tick);
    counts("route_size").push_back(drive.route_points.size());
    const Eigen::Vector3d& meeting = drive.conflict_point;
    for (const double number :
         {driver.target_speed, driver.minimum_gap, driver.time_headway, driver.acceleration,
          driver.deceleration, drive.interaction_score, meeting.x(), meeting.y(), meeting.z()})
      numbers("driver").push_back(number);
    for (std::size_t i = 0; i < drive.route_points.size(); ++i) {
      counts("route_lane").push_back(lanes_.placeOf(drive.route_lanes.at(i)));
      for (const double number : drive.route_points[i]) numbers("route").push_back(number);
    }
  }

  void addLists(const Scene& scene) {
    for (std::size_t i = 0; i < scene.driven.size(); ++i) {
      for (const auto& [slot, drive] : scene.driven[i])
        append("driven", {i, static_cast<std::uint64_t>(slot + 1), drive});
    }
    for (const auto& [id, tick] : scene.disturbed) append("disturbed", {tick, known(id)});
    for (const auto& [tick, contact] : scene.contacts)
      append("contacts", {tick, known(contact.first), known(contact.second)});
  }
  void append(const char* name, std::initializer_list<std::uint64_t> row) {
    counts(name).insert(counts(name).end(), row);
  }
  /// One that was perhaps gone before a decision has a box of no size.
  std::uint64_t known(const std::string& id) { return vehicle(id, {0.0, 0.0, 0.0}); }

  Sample tables_;
  TextList vehicles_;
  TextList lanes_;
  TextList signals_;
};

}  // namespace

Sample tablesOf(const Scene& scene) { return TableWriter().write(scene); }

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

/// Reads the tables of one scene (scene_tables.h), the counterpart of TableWriter; a column
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
