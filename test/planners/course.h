// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Small worlds for planner tests: lanes from points (map frame, m), routes along them, and a
/// closed loop of planner and bicycle model with decisions every 0.1 s (unless told otherwise) and
/// dynamics every 0.05 s.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/text.h"
#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/dynamics/bicycle_model.h"
#include "e2e_cdiff/map/drivable_area.h"
#include "planners/pdm_lite/pdm_lite.h"

namespace cdiff::planners::testing {

using Points = std::vector<Eigen::Vector3d>;

inline constexpr double kNorth = 0.5 * core::kPi;  ///< heading [rad]

/// A lane of its own edge; the edge has the name of the lane without "_0".
struct LaneSpec {
  std::string edge;
  Points points;
  double speed = 13.89;
  bool internal = false;
};

/// A connection between edges, `light` with its link where one controls it, SUMO's letter of the
/// right of way where it matters.
struct LinkSpec {
  std::string from;
  std::string to;
  std::string light;
  std::string state = "M";
};

inline std::string pointText(const Points& points) {
  std::vector<std::string> words;
  for (const Eigen::Vector3d& p : points) {
    words.push_back(core::formatNumber(p.x()) + "," + core::formatNumber(p.y()) + "," +
                    core::formatNumber(p.z()));
  }
  return core::joinText(words, " ");
}

inline map::RoadNetwork makeNetwork(const std::vector<LaneSpec>& lanes,
                                    const std::vector<LinkSpec>& links = {}) {
  std::string xml = "<net>";
  for (const LaneSpec& lane : lanes) {
    xml += "<edge id=\"" + lane.edge + "\"><lane id=\"" + lane.edge + "_0\" index=\"0\" speed=\"" +
           core::formatNumber(lane.speed) + "\" shape=\"" + pointText(lane.points) + "\"/></edge>";
  }
  for (const LinkSpec& link : links) {
    xml += "<connection from=\"" + link.from + "\" to=\"" + link.to +
           "\" fromLane=\"0\" toLane=\"0\" dir=\"s\" state=\"" + link.state + "\"";
    if (!link.light.empty()) xml += " tl=\"" + link.light + "\" linkIndex=\"0\"";
    xml += "/>";
  }
  return map::RoadNetwork::fromText(xml + "</net>", "course");
}

inline Points straight(double x0, double y0, double x1, double y1, double z = 0.0) {
  return {{x0, y0, z}, {x1, y1, z}};
}

/// Straight along +x for `before` meters, 90 degrees left with `radius`, straight along +y for
/// `after` meters; 5-degree chords.
inline Points leftBend(double before, double radius, double after) {
  Points points = {{0.0, 0.0, 0.0}};
  for (int i = 0; i <= 18; ++i) {
    const double angle = core::degreesToRadians(5.0 * i);
    points.emplace_back(before + radius * std::sin(angle), radius * (1.0 - std::cos(angle)), 0.0);
  }
  points.emplace_back(before + radius, radius + after, 0.0);
  return points;
}

/// Route along whole lanes, points 1 m apart.
inline map::Route routeAlong(const map::RoadNetwork& network,
                             const std::vector<std::string>& edges) {
  Points points;
  std::vector<map::LaneIndex> lanes;
  for (const std::string& edge : edges) {
    const map::LaneIndex lane = network.findLane(edge + "_0");
    for (const Eigen::Vector3d& point : network.lane(lane).centerline.resampled(1.0)) {
      points.push_back(point);
      lanes.push_back(lane);
    }
  }
  return map::Route(network, points, lanes);
}

inline traffic::Vehicle vehicleAt(const std::string& id, double x, double y, double heading,
                                  double speed) {
  traffic::Vehicle vehicle;
  vehicle.id = id;
  vehicle.state.position = {x, y};
  vehicle.state.heading = heading;
  vehicle.state.speed = speed;
  return vehicle;
}

/// Options under which all vehicles have one style.
inline PdmLiteOptions styled(const DrivingStyle& style, PdmLiteOptions options = {}) {
  options.styles = [style](const std::string&) { return style; };
  return options;
}

/// Vehicles with a route are driven by the planner; the others go straight at constant speed.
class ClosedLoop {
 public:
  ClosedLoop(const map::RoadNetwork& network, const PdmLiteOptions& options = {},
             double decision_period = 0.1)
      : area_(network),
        decision_period_(decision_period),
        planner_(options, {}, {network, area_, 1, 0.05, decision_period}) {}

  /// The pointers must stay valid. The order of calls is the order of tasks.
  void drive(const traffic::Vehicle& vehicle, const map::Route& route, int slot = -1) {
    snapshot_.vehicles.push_back(vehicle);
    routes_.push_back({snapshot_.vehicles.size() - 1, &route, slot});
  }
  void add(const traffic::Vehicle& vehicle) { snapshot_.vehicles.push_back(vehicle); }
  void setSignal(const std::string& id, const std::string& state) {
    snapshot_.signals = {{id, state}};
  }

  /// One decision and the time up to the next.
  void advance() {
    std::vector<planning::PlanningTask> tasks;
    for (const Driven& driven : routes_) {
      tasks.push_back({driven.slot, &snapshot_.vehicles[driven.index], driven.route, 8.0});
    }
    last_ = planner_.plan(snapshot_, tasks);
    const long ticks = std::lround(decision_period_ / 0.05);
    for (long tick = 0; tick < ticks; ++tick) tickOnce();
    snapshot_.tick += static_cast<std::uint64_t>(ticks);
  }
  /// Runs for `seconds` and calls `check` after each decision.
  void run(
      double seconds, const std::function<void()>& check = [] {}) {
    for (int i = 0; i < std::lround(seconds / decision_period_); ++i) {
      advance();
      check();
    }
  }

  const traffic::Vehicle& vehicle(std::size_t index) const { return snapshot_.vehicles[index]; }
  traffic::Vehicle& vehicle(std::size_t index) { return snapshot_.vehicles[index]; }
  const std::vector<planning::PlannedAction>& actions() const { return last_; }
  PdmLite& planner() { return planner_; }
  traffic::TrafficSnapshot& snapshot() { return snapshot_; }
  const traffic::TrafficSnapshot& snapshot() const { return snapshot_; }

 private:
  struct Driven {
    std::size_t index;
    const map::Route* route;
    int slot;
  };

  void tickOnce() {
    std::vector<bool> driven(snapshot_.vehicles.size(), false);
    for (std::size_t i = 0; i < routes_.size(); ++i) {
      traffic::Vehicle& vehicle = snapshot_.vehicles[routes_[i].index];
      driven[routes_[i].index] = true;
      vehicle.applied_action = last_[i].action;
      vehicle.state = model_.step(vehicle.state, last_[i].action, 0.05);
    }
    for (std::size_t i = 0; i < driven.size(); ++i) {
      traffic::VehicleState& state = snapshot_.vehicles[i].state;
      if (!driven[i]) state.position += 0.05 * state.velocity();
    }
  }

  map::DrivableArea area_;
  double decision_period_;  ///< [s]
  dynamics::BicycleModel model_;
  PdmLite planner_;
  traffic::TrafficSnapshot snapshot_;
  std::vector<Driven> routes_;
  std::vector<planning::PlannedAction> last_;
};

}  // namespace cdiff::planners::testing
