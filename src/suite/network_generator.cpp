// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "suite/network_generator.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <pugixml.hpp>
#include <sstream>
#include <vector>

#include "core/file.h"
#include "core/output_folder.h"
#include "core/text.h"
#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/geometry/shapes.h"
#include "map/import/network_import.h"
#include "suite/crossing_networks.h"
#include "suite/merging_networks.h"

namespace cdiff::suite {
namespace {

constexpr int kDecimals = 2;

std::string number(double value) {
  const std::string text = core::formatFixed(value, kDecimals);
  return text == "-0.00" ? "0.00" : text;
}

/// One of the plain-XML files: its head, and elements without children below its root.
class SourceFile {
 public:
  SourceFile(const RoadPlan& plan, const char* root) {
    pugi::xml_node declaration = document_.append_child(pugi::node_declaration);
    declaration.append_attribute("version") = "1.0";
    declaration.append_attribute("encoding") = "UTF-8";
    addComment("SPDX-License-Identifier: BSD-3-Clause");
    addComment("Copyright (c) 2026 The e2e_cdiff authors");
    addComment(plan.text);
    root_ = document_.append_child(root);
  }

  /// Begins an element; `set` gives it attributes.
  SourceFile& add(const char* name) {
    element_ = root_.append_child(name);
    return *this;
  }
  SourceFile& set(const char* name, const std::string& value) {
    element_.append_attribute(name) = value.c_str();
    return *this;
  }

  std::string text() const {
    std::ostringstream stream;
    document_.save(stream, "    ");
    // pugixml has a blank in front of "/>"; texts hold no such sign, attributes have it escaped.
    std::string text = stream.str();
    for (std::size_t at = text.find(" />"); at != std::string::npos; at = text.find(" />", at))
      text.erase(at, 1);
    return text;
  }

 private:
  void addComment(const std::string& text) {
    document_.append_child(pugi::node_comment).set_value((" " + text + " ").c_str());
  }

  pugi::xml_document document_;
  pugi::xml_node root_;
  pugi::xml_node element_;
};

std::string shapeText(const std::vector<Eigen::Vector3d>& shape) {
  std::vector<std::string> points;
  for (const Eigen::Vector3d& point : shape)
    points.push_back(number(point.x()) + "," + number(point.y()) + "," + number(point.z()));
  return core::joinText(points, " ");
}

void addEdge(const PlanEdge& edge, SourceFile& file) {
  file.add("edge").set("id", edge.id).set("from", edge.from).set("to", edge.to);
  file.set("numLanes", std::to_string(edge.lanes)).set("speed", number(edge.speed));
  file.set("priority", std::to_string(edge.priority));
  if (!edge.shape.empty()) file.set("shape", shapeText(edge.shape));
  if (edge.centered) file.set("spreadType", "center");
}

}  // namespace

std::string nodesXml(const RoadPlan& plan) {
  SourceFile file(plan, "nodes");
  for (const PlanNode& node : plan.nodes) {
    const Eigen::Vector3d& place = node.position;
    file.add("node").set("id", node.id);
    file.set("x", number(place.x())).set("y", number(place.y())).set("z", number(place.z()));
    if (!node.type.empty()) file.set("type", node.type);
  }
  return file.text();
}

std::string edgesXml(const RoadPlan& plan) {
  SourceFile file(plan, "edges");
  for (const PlanEdge& edge : plan.edges) addEdge(edge, file);
  for (const PlanRoundabout& ring : plan.roundabouts) {
    file.add("roundabout").set("nodes", core::joinText(ring.nodes, " "));
    file.set("edges", core::joinText(ring.edges, " "));
  }
  return file.text();
}

std::string connectionsXml(const RoadPlan& plan) {
  if (plan.connections.empty()) return "";
  SourceFile file(plan, "connections");
  for (const PlanConnection& connection : plan.connections) {
    file.add("connection").set("from", connection.from).set("to", connection.to);
    file.set("fromLane", std::to_string(connection.from_lane));
    file.set("toLane", std::to_string(connection.to_lane));
    if (connection.far_view) file.set("visibility", "15");
  }
  return file.text();
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

namespace {

namespace fs = std::filesystem;

/// Without "<!-- generated on ... -->" and what it encloses, and without blank lines in a row.
std::string withoutComment(const std::string& text) {
  const std::size_t begin = text.find("<!-- generated on");
  if (begin == std::string::npos) return text;
  const std::size_t end = text.find("-->", begin);
  if (end == std::string::npos) return text;
  std::size_t rest = text.find_first_not_of('\n', end + 3);
  if (rest == std::string::npos) rest = text.size();
  return text.substr(0, begin) + "\n" + text.substr(rest);
}

/// Writes a source and names it on netconvert's command line.
void addSource(const fs::path& file, const char* option, const std::string& text,
               std::vector<std::string>& command) {
  if (text.empty()) return;
  core::writeOwnFile(file, text);
  command.insert(command.end(), {option, file.string()});
}

}  // namespace

std::string buildNetwork(const RoadPlan& plan, const fs::path& folder) {
  core::OutputFolder output(folder);
  const std::string base = (folder / plan.name).string();
  const fs::path raw = base + ".raw.net.xml";
  std::vector<std::string> command = {
      "-c", (core::shareFolder() / "networks" / "netconvert.netccfg").string()};
  addSource(base + ".nod.xml", "--node-files", nodesXml(plan), command);
  addSource(base + ".edg.xml", "--edge-files", edgesXml(plan), command);
  addSource(base + ".con.xml", "--connection-files", connectionsXml(plan), command);
  output.claim(raw.filename().string());
  command.insert(command.end(), {"--output-file", raw.string()});
  map::runNetconvert(command, "network '" + plan.name + "'");
  const std::string text = withoutComment(core::readFile(raw, "network"));
  core::writeOwnFile(base + ".net.xml", text);
  output.remove({raw.filename().string()});
  return text;
}

double drawSmallSpeed(Draws& draws) {
  return draws.pick(std::array<double, 3>{8.33, 11.11, 13.89});
}

double drawLargeSpeed(Draws& draws) {
  return draws.pick(std::array<double, 4>{11.11, 13.89, 16.67, 19.44});
}

Line ArmShape::draw(const Eigen::Vector2d& start, double heading, double speed,
                    Draws& draws) const {
  constexpr double kStraight = 45.0;  // before the bend [m]
  constexpr double kBendShare = 0.7;
  constexpr double kSideways = 3.0;  // [m/s^2]
  RoadLine road(start, heading);
  road.straight(draws.uniform(kStraight, kStraight + 20.0));
  const double length = draws.uniform(60.0, 90.0);
  const double radius = draws.uniform(1.0, 2.0) * speed * speed / kSideways;
  const double angle = core::degreesToRadians(draws.uniform(15.0, 50.0));
  if (draws.chance(kBendShare)) road.arc(radius, side_ * angle);
  road.straight(length);
  const double height = draws.sign() * draws.uniform(2.0, 5.0);
  return elevation_ ? climbing(road.points(), kStraight, height) : road.points();
}

void addArm(const ArmPlan& arm, RoadPlan& plan) {
  plan.nodes.push_back({arm.name, arm.line.back(), ""});
  plan.edges.push_back({arm.name + "_in", arm.name, arm.inner, arm.lanes, arm.speed, arm.priority,
                        reversed(arm.line), false});
  plan.edges.push_back({arm.name + "_out", arm.inner, arm.name, arm.lanes, arm.speed, arm.priority,
                        arm.line, false});
}

RoadPlan drawNetwork(const NetworkSpec& spec, Draws& draws) {
  switch (spec.kind) {
    case NetworkKind::kRoundabout:
      return drawRoundabout(spec, draws);
    case NetworkKind::kMerge:
      return drawMerge(spec, draws);
    case NetworkKind::kDistrict:
      return drawDistrict(spec, draws);
    case NetworkKind::kCrossing:
      break;
  }
  return drawCrossing(spec, draws);
}

}  // namespace cdiff::suite
