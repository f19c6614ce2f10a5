// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "suite/road_plan.h"

#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "e2e_cdiff/geometry/polyline.h"

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

RoadLine::RoadLine(const Eigen::Vector2d& start, double heading)
    : position_(start), heading_(heading), points_{{start.x(), start.y(), 0.0}} {}

RoadLine& RoadLine::straight(double length) {
  constexpr double kSpacing = 5.0;  // [m]
  const int pieces = std::max(1, static_cast<int>(std::ceil(length / kSpacing)));
  const Eigen::Vector2d start = position_;
  for (int i = 1; i <= pieces; ++i) {
    position_ = start + length * i / pieces * geometry::direction(heading_);
    points_.emplace_back(position_.x(), position_.y(), 0.0);
  }
  return *this;
}

RoadLine& RoadLine::arc(double radius, double angle) {
  const int pieces = std::max(3, static_cast<int>(std::ceil(radius * std::abs(angle))));
  const double side = angle > 0.0 ? 1.0 : -1.0;
  const Eigen::Vector2d start = position_;
  const Eigen::Vector2d forward = geometry::direction(heading_);
  const Eigen::Vector2d left(-forward.y(), forward.x());
  for (int i = 1; i <= pieces; ++i) {
    const double turned = std::abs(angle) * i / pieces;
    position_ = start + radius * std::sin(turned) * forward +
                side * radius * (1.0 - std::cos(turned)) * left;
    points_.emplace_back(position_.x(), position_.y(), 0.0);
  }
  heading_ += angle;
  return *this;
}

Line beside(const Line& line, double offset) {
  Line moved;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const Eigen::Vector3d& before = line[i == 0 ? 0 : i - 1];
    const Eigen::Vector3d& after = line[std::min(i + 1, line.size() - 1)];
    const Eigen::Vector2d forward = (after - before).head<2>().normalized();
    moved.emplace_back(line[i].x() - offset * forward.y(), line[i].y() + offset * forward.x(),
                       line[i].z());
  }
  return moved;
}

Line reversed(Line line) {
  std::reverse(line.begin(), line.end());
  return line;
}

Line climbing(Line line, double begin, double height) {
  const geometry::Polyline path(line);
  for (std::size_t i = 0; i < line.size(); ++i) {
    const double share = (path.arcLengths()[i] - begin) / (path.length() - begin);
    const double u = std::clamp(share, 0.0, 1.0);
    line[i].z() = height * u * u * (3.0 - 2.0 * u);
  }
  return line;
}

Line part(const Line& line, double begin, double end) {
  return geometry::Polyline(line).slice(begin, end).points();
}

double lengthOf(const Line& line) { return geometry::Polyline(line).length(); }

}  // namespace cdiff::suite
