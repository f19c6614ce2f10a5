// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <limits>

#include "planning/surrounding_vehicles.h"

namespace cdiff::planning {
namespace {

void add(traffic::TrafficSnapshot& snapshot, const std::string& id, double x, double z = 0.0) {
  traffic::Vehicle vehicle;
  vehicle.id = id;
  vehicle.state.position = {x, 0.0};
  vehicle.state.elevation = z;
  snapshot.vehicles.push_back(vehicle);
}

std::vector<std::string> idsOf(const std::vector<const traffic::Vehicle*>& vehicles) {
  std::vector<std::string> ids;
  for (const traffic::Vehicle* vehicle : vehicles) ids.push_back(vehicle->id);
  return ids;
}

TEST(SurroundingVehicles, NearestFirstOnTheSameLevelWithinTheRadius) {
  traffic::TrafficSnapshot snapshot;
  add(snapshot, "me", 0.0);
  add(snapshot, "far", 51.0);
  add(snapshot, "b", -20.0);
  add(snapshot, "a", 20.0);
  add(snapshot, "bridge", 5.0, 8.0);
  add(snapshot, "broken", std::numeric_limits<double>::quiet_NaN());
  add(snapshot, "ego", 10.0);
  const traffic::Vehicle& me = snapshot.vehicles.front();
  EXPECT_EQ(nearestVehicle(snapshot, me)->id, "ego");
  EXPECT_EQ(idsOf(vehiclesAround(snapshot, me, &snapshot.vehicles.back())),
            (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(idsOf(vehiclesAround(snapshot, me, nullptr)),
            (std::vector<std::string>{"ego", "a", "b"}));
}

TEST(SurroundingVehicles, EightAtMostAndNoneAlone) {
  traffic::TrafficSnapshot snapshot;
  add(snapshot, "me", 0.0);
  EXPECT_EQ(nearestVehicle(snapshot, snapshot.vehicles.front()), nullptr);
  for (int i = 1; i < 12; ++i) add(snapshot, "v" + std::to_string(i), 2.0 * i);
  const auto around = vehiclesAround(snapshot, snapshot.vehicles.front(), nullptr);
  ASSERT_EQ(around.size(), 8U);
  EXPECT_EQ(around.back()->id, "v8");
}

}  // namespace
}  // namespace cdiff::planning
