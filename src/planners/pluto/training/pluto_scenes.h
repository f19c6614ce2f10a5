// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "e2e_cdiff/map/drivable_area.h"
#include "learning/samples/scene.h"
#include "planners/pluto/pluto_scene.h"

namespace cdiff::planners {

/// A road network with what moments on it are made of.
struct PlutoWorld {
  map::RoadNetwork network;
  map::DrivableArea area;
  PlutoSceneBuilder builder;

  PlutoWorld(const PlutoArchitecture& architecture, map::RoadNetwork roads)
      : network(std::move(roads)), area(network), builder(architecture, network) {}
  PlutoWorld(const PlutoWorld&) = delete;
  PlutoWorld& operator=(const PlutoWorld&) = delete;
};

/// A vehicle that was driven in a scene.
struct PlutoDrive {
  std::uint32_t vehicle = 0;
  map::Route route;
  double target_speed = 8.0;  ///< [m/s]
  /// Decision -> arc length on the route [m], where an action of ours was applied before it.
  std::map<std::size_t, double> places;
  std::set<std::size_t> disturbed;  ///< decisions with noise or a fault
};

/// A scene small enough to keep many: tracks, lights and drives (map frame, SI units).
class PlutoScene {
 public:
  /// Throws InputError naming decisions that are not 0.1 s apart.
  PlutoScene(const learning::Scene& scene, std::shared_ptr<const PlutoWorld> world);

  const std::string& name() const { return name_; }
  const PlutoWorld& world() const { return *world_; }
  const std::vector<TrackFrame>& frames() const { return frames_; }
  const VehicleTable& vehicles() const { return vehicles_; }
  const std::vector<PlutoDrive>& drives() const { return drives_; }
  const std::vector<traffic::SignalState>& signals(std::size_t decision) const {
    return signals_[signals_at_[decision]];
  }
  /// Whether a vehicle began to touch another between two decisions, both included.
  bool touches(std::uint32_t vehicle, std::size_t begin, std::size_t end) const;
  /// The drive's vehicle at a decision with up to two seconds before; it must be there.
  PlutoMoment moment(std::size_t decision, std::size_t drive) const;

 private:
  void addDrives(const learning::Scene& scene);
  void follow(const learning::Scene& scene);

  std::string name_;
  std::shared_ptr<const PlutoWorld> world_;
  VehicleTable vehicles_;
  std::vector<TrackFrame> frames_;
  std::vector<std::vector<traffic::SignalState>> signals_;  ///< each state of all lights once
  std::vector<std::size_t> signals_at_;                     ///< by decision
  std::vector<PlutoDrive> drives_;
  std::set<std::pair<std::uint32_t, std::size_t>> contacts_;  ///< vehicle, decision after it
};

/// The networks of scenes, each once.
class PlutoWorlds {
 public:
  explicit PlutoWorlds(const PlutoArchitecture& architecture) : architecture_(architecture) {}
  std::shared_ptr<const PlutoWorld> of(const learning::Scene& scene);

 private:
  PlutoArchitecture architecture_;
  std::map<std::string, std::shared_ptr<const PlutoWorld>> worlds_;  ///< by SHA-256 of the text
};

}  // namespace cdiff::planners
