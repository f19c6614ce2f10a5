// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
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

}  // namespace cdiff::learning
