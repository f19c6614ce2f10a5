// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "session/contacts.h"

#include <algorithm>

namespace cdiff::session {
namespace {

using traffic::Vehicle;

bool touch(const Vehicle& ours, const Vehicle& other) {
  const double reach = 0.5 * (ours.dimensions.length + ours.dimensions.width +
                              other.dimensions.length + other.dimensions.width);
  if ((ours.state.position - other.state.position).squaredNorm() > reach * reach) return false;
  return !traffic::onDifferentLevels(ours, other) && geometry::overlap(ours.box(), other.box());
}

}  // namespace

TickContacts findContacts(const std::vector<Vehicle>& vehicles, std::size_t driven) {
  TickContacts found;
  for (std::size_t i = 0; i < driven; ++i) {
    for (std::size_t j = i + 1; j < vehicles.size(); ++j) {
      if (!touch(vehicles[i], vehicles[j])) continue;
      const auto [first, second] = std::minmax(vehicles[i].id, vehicles[j].id);
      found.contacts.push_back({first, second});
      for (const Vehicle* vehicle : {&vehicles[i], &vehicles[j]}) {
        if (vehicle->role != traffic::VehicleRole::kEgo) found.leaving.push_back(vehicle->id);
      }
    }
  }
  return found;
}

}  // namespace cdiff::session
