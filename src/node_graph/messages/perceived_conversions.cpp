// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/messages/perceived_conversions.h"

#include <algorithm>

#include "node_graph/messages/traffic_conversions.h"

namespace cdiff::node_graph {
namespace {

using Places = std::vector<Eigen::Vector2d>;
using Numbers = std::vector<double>;

void writePlaces(const Places& places, Numbers& x, Numbers& y) {
  for (const Eigen::Vector2d& place : places) {
    x.push_back(place.x());
    y.push_back(place.y());
  }
}

/// As many as have both coordinates.
Places readPlaces(const Numbers& x, const Numbers& y) {
  Places places;
  for (std::size_t i = 0; i < std::min(x.size(), y.size()); ++i) places.emplace_back(x[i], y[i]);
  return places;
}

msgs::PerceivedVehicle toMsg(const planning::PerceivedVehicle& vehicle) {
  msgs::PerceivedVehicle message;
  message.state = node_graph::toMsg(vehicle.state);
  message.length = vehicle.dimensions.length;
  message.width = vehicle.dimensions.width;
  message.height = vehicle.dimensions.height;
  message.score = vehicle.score;
  for (const planning::PerceivedForecast& forecast : vehicle.forecasts) {
    msgs::PerceivedForecast& way = message.forecasts.emplace_back();
    writePlaces(forecast.places, way.x, way.y);
    way.probability = forecast.probability;
  }
  return message;
}

planning::PerceivedVehicle fromMsg(const msgs::PerceivedVehicle& message) {
  planning::PerceivedVehicle vehicle;
  vehicle.state = node_graph::fromMsg(message.state);
  vehicle.dimensions = {message.length, message.width, message.height};
  vehicle.score = message.score;
  for (const msgs::PerceivedForecast& way : message.forecasts)
    vehicle.forecasts.push_back({readPlaces(way.x, way.y), way.probability});
  return vehicle;
}

msgs::PerceivedOccupancy toMsg(const planning::PerceivedOccupancy& occupancy) {
  msgs::PerceivedOccupancy message;
  message.time = occupancy.time;
  message.x = occupancy.frame.position.x();
  message.y = occupancy.frame.position.y();
  message.heading = occupancy.frame.heading;
  message.origin_x = occupancy.origin.x();
  message.origin_y = occupancy.origin.y();
  message.cell = occupancy.cell;
  message.rows = occupancy.rows;
  message.columns = occupancy.columns;
  message.probability = occupancy.probability;
  return message;
}

planning::PerceivedOccupancy fromMsg(const msgs::PerceivedOccupancy& message) {
  planning::PerceivedOccupancy occupancy;
  occupancy.time = message.time;
  occupancy.frame = {{message.x, message.y}, message.heading};
  occupancy.origin = {message.origin_x, message.origin_y};
  occupancy.cell = message.cell;
  occupancy.rows = message.rows;
  occupancy.columns = message.columns;
  occupancy.probability = message.probability;
  return occupancy;
}

}  // namespace

msgs::Perception toMsg(const planning::Perception& perception) {
  msgs::Perception message;
  for (const planning::PerceivedVehicle& vehicle : perception.vehicles)
    message.vehicles.push_back(toMsg(vehicle));
  for (const planning::PerceivedLine& line : perception.lines) {
    msgs::PerceivedLine& written = message.lines.emplace_back();
    written.kind = line.kind;
    writePlaces(line.points, written.x, written.y);
    written.score = line.score;
  }
  for (const planning::PerceivedOccupancy& occupancy : perception.occupancy)
    message.occupancy.push_back(toMsg(occupancy));
  return message;
}

planning::Perception fromMsg(const msgs::Perception& message) {
  planning::Perception perception;
  for (const msgs::PerceivedVehicle& vehicle : message.vehicles)
    perception.vehicles.push_back(fromMsg(vehicle));
  for (const msgs::PerceivedLine& line : message.lines)
    perception.lines.push_back({line.kind, readPlaces(line.x, line.y), line.score});
  for (const msgs::PerceivedOccupancy& occupancy : message.occupancy) {
    const auto cells = static_cast<std::int64_t>(occupancy.rows) * occupancy.columns;
    if (cells == static_cast<std::int64_t>(occupancy.probability.size()))
      perception.occupancy.push_back(fromMsg(occupancy));
  }
  return perception;
}

}  // namespace cdiff::node_graph
