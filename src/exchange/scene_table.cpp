// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "exchange/scene_table.h"

#include <map>

#include "core/csv.h"
#include "core/text.h"

namespace cdiff::exchange {
namespace {

constexpr const char* kTableHeader = "time,id,role,x,y,z,heading,speed,length,width,height\n";

std::string tableRow(double seconds, const SceneVehicle& vehicle, const SceneState& state) {
  const traffic::VehicleState& pose = state.pose;
  const traffic::VehicleDimensions& size = vehicle.dimensions;
  std::vector<std::string> cells = {core::formatNumber(seconds), vehicle.id,
                                    traffic::toText(vehicle.role)};
  for (const double value : {pose.position.x(), pose.position.y(), pose.elevation, pose.heading,
                             pose.speed, size.length, size.width, size.height})
    cells.push_back(core::formatNumber(value));
  return core::csvRow(cells);
}

}  // namespace

std::string sceneTable(const RecordedScene& scene) {
  std::map<std::uint64_t, std::string> rows;  // by tick
  for (const SceneVehicle& vehicle : scene.vehicles) {
    for (const SceneState& state : vehicle.states)
      rows[state.step] += tableRow(scene.seconds(state.step), vehicle, state);
  }
  std::string text = kTableHeader;
  for (const auto& [step, lines] : rows) text += lines;
  return text;
}

}  // namespace cdiff::exchange
