// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "learning/samples/scene_tables.h"

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

}  // namespace cdiff::learning
