// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "exchange/commonroad_writer.h"

#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/core/exceptions.h"
#include "exchange/xml_tree.h"
#include "rendering/lane_surface.h"
#include "traffic/vehicle_class.h"

namespace cdiff::exchange {
namespace {

using pugi::xml_node;

/// The format's numbers have no exponent.
std::string decimal(double value) { return core::formatFixed(value, 6); }

void addPoint(xml_node parent, const Eigen::Vector3d& point, bool with_elevation) {
  const xml_node node = append(parent, "point");
  appendText(node, "x", decimal(point.x()));
  appendText(node, "y", decimal(point.y()));
  if (with_elevation) appendText(node, "z", decimal(point.z()));
}

void addExact(xml_node parent, const char* name, const std::string& value) {
  appendText(append(parent, name), "exact", value);
}

// Ids of elements are positive: lanelets have the index of their lane plus one.

std::string laneletId(map::LaneIndex lane) { return std::to_string(lane + 1); }

void addBound(xml_node lanelet, const char* name,
              const std::vector<rendering::CrossSection>& sections, double lateral) {
  const xml_node bound = append(lanelet, name);
  // Readers take points with z for those of a road in space.
  const bool flat = std::all_of(sections.begin(), sections.end(), [](const auto& section) {
    return std::abs(section.at(0.0).z()) < 1e-9;
  });
  for (const rendering::CrossSection& section : sections)
    addPoint(bound, section.at(lateral), !flat);
}

void addLinks(xml_node lanelet, const map::RoadNetwork& network, const map::Lane& lane) {
  const auto drivable = [&](map::LaneIndex index) {
    return index != map::kNoLane && network.lane(index).allows_cars;
  };
  for (const map::LaneIndex before : lane.previous)
    if (drivable(before)) append(lanelet, "predecessor", {{"ref", laneletId(before)}});
  for (const map::LaneLink& link : lane.next)
    if (drivable(link.to)) append(lanelet, "successor", {{"ref", laneletId(link.to)}});
  for (const auto& [name, beside] :
       {std::make_pair("adjacentLeft", lane.left), std::make_pair("adjacentRight", lane.right)}) {
    if (drivable(beside))
      append(lanelet, name, {{"ref", laneletId(beside)}, {"drivingDir", "same"}});
  }
}

void addLanelets(xml_node root, const map::RoadNetwork& network) {
  constexpr double kAnySpacing = 1e9;  // [m] the points of the centerline alone
  for (std::size_t i = 0; i < network.lanes().size(); ++i) {
    const map::Lane& lane = network.lanes()[i];
    if (!lane.allows_cars) continue;
    const xml_node lanelet =
        append(root, "lanelet", {{"id", laneletId(static_cast<map::LaneIndex>(i))}});
    const auto sections =
        rendering::crossSections(lane.centerline, 0.0, lane.centerline.length(), kAnySpacing);
    addBound(lanelet, "leftBound", sections, 0.5 * lane.width);
    addBound(lanelet, "rightBound", sections, -0.5 * lane.width);
    addLinks(lanelet, network, lane);
    appendText(lanelet, "laneletType", "urban");
    appendText(lanelet, "userOneWay", "vehicle");
  }
}

void addRectangle(xml_node parent, const traffic::VehicleDimensions& size) {
  const xml_node rectangle = append(parent, "rectangle");
  appendText(rectangle, "length", decimal(size.length));
  appendText(rectangle, "width", decimal(size.width));
}

void addState(xml_node node, const SceneState& state) {
  const traffic::VehicleState& pose = state.pose;
  addPoint(append(node, "position"), {pose.position.x(), pose.position.y(), pose.elevation}, false);
  addExact(node, "orientation", decimal(core::wrapAngle(pose.heading)));
  addExact(node, "time", std::to_string(state.step));
  addExact(node, "velocity", decimal(pose.speed));
}

void addObstacle(xml_node root, const SceneVehicle& vehicle, std::size_t id) {
  const xml_node obstacle = append(root, "dynamicObstacle", {{"id", std::to_string(id)}});
  const bool upright = traffic::isUpright(vehicle.dimensions);
  appendText(obstacle, "type", upright ? "pedestrian" : vehicleWord(vehicle.dimensions));
  addRectangle(append(obstacle, "shape"), vehicle.dimensions);
  addState(append(obstacle, "initialState"), vehicle.states.front());
  const xml_node trajectory = append(obstacle, "trajectory");
  for (std::size_t i = 1; i < vehicle.states.size(); ++i)
    addState(append(trajectory, "state"), vehicle.states[i]);
}

/// From the ego's first place to its last one, at any time of the scene.
void addProblem(xml_node root, const SceneVehicle& ego, std::size_t id) {
  const xml_node problem = append(root, "planningProblem", {{"id", std::to_string(id)}});
  const xml_node start = append(problem, "initialState");
  addState(start, ego.states.front());
  addExact(start, "yawRate", decimal(0.0));
  addExact(start, "slipAngle", decimal(0.0));
  const SceneState& last = ego.states.back();
  const xml_node goal = append(problem, "goalState");
  const xml_node time = append(goal, "time");
  appendText(time, "intervalStart", "0");
  appendText(time, "intervalEnd", std::to_string(last.step));
  const xml_node place = append(append(goal, "position"), "rectangle");
  appendText(place, "length", decimal(ego.dimensions.length));
  appendText(place, "width", decimal(ego.dimensions.width));
  appendText(place, "orientation", decimal(core::wrapAngle(last.pose.heading)));
  const xml_node center = append(place, "center");
  appendText(center, "x", decimal(last.pose.position.x()));
  appendText(center, "y", decimal(last.pose.position.y()));
}

/// The format's names of maps have letters and digits alone.
std::string mapName(const std::string& scenario) {
  std::string name = core::fileName(scenario);
  for (const char* other : {"_", "-", "."})
    name = core::joinText(core::splitText(name, *other), "");
  return name.empty() ? "Scenario" : name;
}

xml_node addRoot(pugi::xml_document& document, const RecordedScene& scene) {
  const SceneFacts& facts = scene.facts;
  const xml_node root =
      append(document, "commonRoad",
             {{"commonRoadVersion", "2020a"},
              {"benchmarkID", "ZAM_" + mapName(facts.scenario) + "-1_1_T-1"},
              {"date", "1970-01-01"},  // the result does not say when it was made
              {"author", "e2e_cdiff"},
              {"affiliation", "e2e_cdiff"},
              {"source", "scenario " + facts.scenario + ", seed " + std::to_string(facts.seed) +
                             ", mode " + facts.mode + ", trace " + facts.trace_sha256},
              {"timeStepSize", decimal(scene.step)}});
  const xml_node location = append(root, "location");
  appendText(location, "geoNameId", "-999");  // unknown, as are latitude and longitude
  appendText(location, "gpsLatitude", "999");
  appendText(location, "gpsLongitude", "999");
  append(append(root, "scenarioTags"), "simulated");
  return root;
}

const SceneVehicle& egoOf(const RecordedScene& scene) {
  for (const SceneVehicle& vehicle : scene.vehicles) {
    if (vehicle.role == traffic::VehicleRole::kEgo && vehicle.states.front().step == 0 &&
        vehicle.states.size() > 1)
      return vehicle;
  }
  throw core::InputError("scenario '" + scene.facts.scenario +
                         "': a CommonRoad file needs the ego at its start and after it; choose "
                         "--vehicles with ego, and --from where it drives");
}

}  // namespace

CommonRoadFile commonRoadFile(const RecordedScene& scene) {
  const SceneVehicle& ego = egoOf(scene);
  const auto network = map::RoadNetwork::fromText(scene.import.text, scene.import.source.string());
  pugi::xml_document document;
  const xml_node root = addRoot(document, scene);
  addLanelets(root, network);
  CommonRoadFile file;
  std::size_t id = network.lanes().size();
  for (const SceneVehicle& vehicle : scene.vehicles) {
    if (&vehicle == &ego) continue;
    if (vehicle.states.front().step > 0 || vehicle.states.size() < 2) {
      ++file.left_out;
    } else {
      addObstacle(root, vehicle, ++id);
    }
  }
  addProblem(root, ego, ++id);
  file.text = documentText(document);
  return file;
}

}  // namespace cdiff::exchange
