// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "learning/samples/scene_tables.h"

#include <stdexcept>
#include <string_view>
#include <unordered_map>

#include "traffic/vehicle_class.h"

namespace cdiff::learning {
namespace {

using traffic::Vehicle;

double pedalOf(const Vehicle& vehicle, double traffic::ControlAction::*part) {
  return vehicle.applied_action ? (*vehicle.applied_action).*part : 0.0;
}

void setPedal(Vehicle& vehicle, double traffic::ControlAction::*part, double value) {
  if (vehicle.applied_action) (*vehicle.applied_action).*part = value;
}

FieldSpec table(const char* name, FieldType type, std::int64_t columns = 1) {
  FieldSpec spec(name, type, {kAnyCount, columns});
  spec.packed = true;
  return spec;
}

SampleSchema makeSchema() {
  SampleSchema schema;
  const auto add = [&](FieldType type, std::initializer_list<const char*> names) {
    for (const char* name : names) schema.fields.push_back(table(name, type));
  };
  // Texts; the lists are joined by zero bytes.
  add(FieldType::kU8, {"name", "scenario", "network_source", "network_source_sha256", "network",
                       "vehicle_ids", "lane_ids", "signal_ids", "signal_states"});
  // By vehicle of vehicle_ids: length, width, height [m]; traffic::VehicleClass.
  schema.fields.push_back(table("dimensions", FieldType::kF64, 3));
  add(FieldType::kU8, {"class"});
  // By decision; then by vehicle of each decision.
  add(FieldType::kU64, {"tick", "vehicles", "signals", "vehicle", "lane"});
  add(FieldType::kF64, {"time"});
  add(FieldType::kU8, {"role", "slot", "has_action"});
  for (const StateColumn& column : stateColumns()) add(FieldType::kF64, {column.name});
  // By drive; then by point of each route.
  add(FieldType::kU64, {"drive_vehicle", "drive_tick", "route_size", "route_lane"});
  schema.fields.push_back(
      table("driver", FieldType::kF64, static_cast<std::int64_t>(kDriverNumbers)));
  schema.fields.push_back(table("route", FieldType::kF64, 3));
  // Rows of decision, slot + 1, drive; of tick, vehicle; of tick, first and second vehicle.
  schema.fields.push_back(table("driven", FieldType::kU64, 3));
  schema.fields.push_back(table("disturbed", FieldType::kU64, 2));
  schema.fields.push_back(table("contacts", FieldType::kU64, 3));
  add(FieldType::kF64, {"seconds"});
  return schema;
}

}  // namespace

const std::vector<StateColumn>& stateColumns() {
  static const std::vector<StateColumn> columns = {
      {"x", [](const Vehicle& v) { return v.state.position.x(); },
       [](Vehicle& v, double value) { v.state.position.x() = value; }},
      {"y", [](const Vehicle& v) { return v.state.position.y(); },
       [](Vehicle& v, double value) { v.state.position.y() = value; }},
      {"z", [](const Vehicle& v) { return v.state.elevation; },
       [](Vehicle& v, double value) { v.state.elevation = value; }},
      {"heading", [](const Vehicle& v) { return v.state.heading; },
       [](Vehicle& v, double value) { v.state.heading = value; }},
      {"speed", [](const Vehicle& v) { return v.state.speed; },
       [](Vehicle& v, double value) { v.state.speed = value; }},
      {"acceleration", [](const Vehicle& v) { return v.acceleration; },
       [](Vehicle& v, double value) { v.acceleration = value; }},
      {"yaw_rate", [](const Vehicle& v) { return v.yaw_rate; },
       [](Vehicle& v, double value) { v.yaw_rate = value; }},
      {"throttle", [](const Vehicle& v) { return pedalOf(v, &traffic::ControlAction::throttle); },
       [](Vehicle& v, double value) { setPedal(v, &traffic::ControlAction::throttle, value); }},
      {"steer", [](const Vehicle& v) { return pedalOf(v, &traffic::ControlAction::steer); },
       [](Vehicle& v, double value) { setPedal(v, &traffic::ControlAction::steer, value); }},
      {"brake", [](const Vehicle& v) { return pedalOf(v, &traffic::ControlAction::brake); },
       [](Vehicle& v, double value) { setPedal(v, &traffic::ControlAction::brake, value); }}};
  return columns;
}

const SampleSchema& sceneSchema() {
  static const SampleSchema schema = makeSchema();
  return schema;
}

namespace {

using Bytes = std::vector<std::uint8_t>;
using Counts = std::vector<std::uint64_t>;
using Numbers = std::vector<double>;

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

std::string textOfBytes(const Bytes& bytes) { return std::string(bytes.begin(), bytes.end()); }

/// Texts of a list, each closed by a zero byte.
std::vector<std::string> listOf(const Bytes& bytes) {
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
      : ids_(listOf(tables.get<Bytes>("vehicle_ids"))),
        lanes_(lanes),
        sizes_(tables.get<Numbers>("dimensions")),
        vehicle_(tables.get<Counts>("vehicle")),
        lane_(tables.get<Counts>("lane")),
        role_(tables.get<Bytes>("role")),
        slot_(tables.get<Bytes>("slot")),
        has_action_(tables.get<Bytes>("has_action")) {
    for (const StateColumn& column : stateColumns())
      numbers_.push_back(&tables.get<Numbers>(column.name));
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
  const Numbers& sizes_;   ///< length, width, height of each vehicle [m]
  const Counts& vehicle_;  ///< by row: index in ids_
  const Counts& lane_;     ///< by row: index in lanes_
  const Bytes& role_;
  const Bytes& slot_;  ///< by row: slot + 1
  const Bytes& has_action_;
  std::vector<const Numbers*> numbers_;  ///< by state column
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
  const Bytes& bytes(const char* name) const { return tables_.get<Bytes>(name); }
  const Counts& counts(const char* name) const { return tables_.get<Counts>(name); }
  const Numbers& numbers(const char* name) const { return tables_.get<Numbers>(name); }
  std::string text(const char* name) const { return textOfBytes(bytes(name)); }

  void readDecisions(Scene& scene) {
    const Counts& ticks = counts("tick");
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
    const Counts& vehicles = counts("drive_vehicle");
    const Numbers& route = numbers("route");
    const Counts& lanes = counts("route_lane");
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
    const Numbers& all = numbers("driver");
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
    const Counts& driven = counts("driven");
    for (std::size_t i = 0; i < driven.size(); i += 3) {
      if (driven.at(i + 2) >= scene.drives.size()) throw std::out_of_range("drive");
      scene.driven.at(driven[i])[static_cast<int>(driven.at(i + 1)) - 1] = driven.at(i + 2);
    }
    const Counts& disturbed = counts("disturbed");
    for (std::size_t i = 0; i < disturbed.size(); i += 2)
      scene.disturbed.insert({ids.at(disturbed.at(i + 1)), disturbed[i]});
    const Counts& contacts = counts("contacts");
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
