// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "suite/road_plan.h"

#include "core/text.h"

namespace cdiff::suite {
namespace {

constexpr int kDecimals = 2;

std::string attribute(const char* name, const std::string& value) {
  return std::string(" ") + name + "=\"" + value + "\"";
}

std::string number(double value) {
  const std::string text = core::formatFixed(value, kDecimals);
  return text == "-0.00" ? "0.00" : text;
}

std::string head(const RoadPlan& plan) {
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
         "<!-- SPDX-License-Identifier: BSD-3-Clause -->\n"
         "<!-- Copyright (c) 2026 The e2e_cdiff authors -->\n<!-- " +
         plan.text + " -->\n";
}

std::string shapeText(const std::vector<Eigen::Vector3d>& shape) {
  std::vector<std::string> points;
  for (const Eigen::Vector3d& point : shape)
    points.push_back(number(point.x()) + "," + number(point.y()) + "," + number(point.z()));
  return core::joinText(points, " ");
}

std::string edgeXml(const PlanEdge& edge) {
  std::string text = "    <edge" + attribute("id", edge.id) + attribute("from", edge.from) +
                     attribute("to", edge.to) + attribute("numLanes", std::to_string(edge.lanes)) +
                     attribute("speed", number(edge.speed)) +
                     attribute("priority", std::to_string(edge.priority));
  if (!edge.shape.empty()) text += attribute("shape", shapeText(edge.shape));
  if (edge.centered) text += attribute("spreadType", "center");
  return text + "/>\n";
}

}  // namespace

std::string nodesXml(const RoadPlan& plan) {
  std::string text = head(plan) + "<nodes>\n";
  for (const PlanNode& node : plan.nodes) {
    text += "    <node" + attribute("id", node.id) + attribute("x", number(node.position.x())) +
            attribute("y", number(node.position.y())) + attribute("z", number(node.position.z()));
    if (!node.type.empty()) text += attribute("type", node.type);
    text += "/>\n";
  }
  return text + "</nodes>\n";
}

std::string edgesXml(const RoadPlan& plan) {
  std::string text = head(plan) + "<edges>\n";
  for (const PlanEdge& edge : plan.edges) text += edgeXml(edge);
  for (const PlanRoundabout& ring : plan.roundabouts) {
    text += "    <roundabout" + attribute("nodes", core::joinText(ring.nodes, " ")) +
            attribute("edges", core::joinText(ring.edges, " ")) + "/>\n";
  }
  return text + "</edges>\n";
}

std::string connectionsXml(const RoadPlan& plan) {
  if (plan.connections.empty()) return "";
  std::string text = head(plan) + "<connections>\n";
  for (const PlanConnection& connection : plan.connections) {
    text += "    <connection" + attribute("from", connection.from) +
            attribute("to", connection.to) +
            attribute("fromLane", std::to_string(connection.from_lane)) +
            attribute("toLane", std::to_string(connection.to_lane));
    if (connection.far_view) text += attribute("visibility", "15");
    text += "/>\n";
  }
  return text + "</connections>\n";
}

}  // namespace cdiff::suite
