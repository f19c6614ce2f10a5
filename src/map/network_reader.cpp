// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "map/network_reader.h"

#include <algorithm>
#include <cstring>
#include <pugixml.hpp>

#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/geometry/shapes.h"
#include "map/spatial_index.h"

namespace cdiff::map {
namespace {

constexpr double kLowestRoutableSpeed = 2.0;  // [m/s]
constexpr double kDrawnLength = 0.01;         // [m] drawn for a lane whose points all coincide
constexpr double kDistinctPoints = 1e-3;      // [m] points nearer than this are one
constexpr double kLargestWidth = 100.0;       // [m] of a lane
constexpr double kLargestExtent = 1e6;        // [m] between two points of a network

bool names(const std::string& classes, const char* vehicle_class) {
  const std::vector<std::string> words = core::splitText(classes, ' ');
  return std::find(words.begin(), words.end(), vehicle_class) != words.end();
}

/// SUMO reads a missing or empty `allow` beside a missing or empty `disallow` as "every class".
bool allowsCars(const pugi::xml_node& lane) {
  const std::string allow = lane.attribute("allow").value();
  const std::string disallow = lane.attribute("disallow").value();
  if (!allow.empty()) return names(allow, "passenger") || names(allow, "all");
  return !names(disallow, "passenger") && !names(disallow, "all");
}

/// The junction that an internal edge ":junction_3" lies in.
std::string junctionOfInternalEdge(const std::string& edge_id) {
  const std::size_t end = edge_id.rfind('_');
  return edge_id.substr(1, end == std::string::npos ? std::string::npos : end - 1);
}

std::size_t lineOfOffset(std::string_view text, std::ptrdiff_t offset) {
  const auto end = text.begin() +
                   std::clamp<std::ptrdiff_t>(offset, 0, static_cast<std::ptrdiff_t>(text.size()));
  return static_cast<std::size_t>(std::count(text.begin(), end, '\n')) + 1;
}

bool degenerate(const std::vector<Eigen::Vector3d>& shape) {
  double length = 0.0;
  for (std::size_t i = 1; i < shape.size(); ++i) {
    length = std::max(length, (shape[i] - shape[0]).head<2>().norm());
  }
  return length < kDistinctPoints;
}

double headingAtEnd(const std::vector<Eigen::Vector3d>& shape) {
  for (std::size_t i = shape.size(); i-- > 1;) {
    const Eigen::Vector3d along = shape.back() - shape[i - 1];
    if (along.head<2>().norm() >= kDistinctPoints) return std::atan2(along.y(), along.x());
  }
  return 0.0;
}

double startHeading(const std::vector<Eigen::Vector3d>& shape) {
  for (std::size_t i = 1; i < shape.size(); ++i) {
    const Eigen::Vector3d along = shape[i] - shape.front();
    if (along.head<2>().norm() >= kDistinctPoints) return std::atan2(along.y(), along.x());
  }
  return 0.0;
}

}  // namespace

void NetworkReader::fail(const std::string& what) const {
  throw core::InputError("network '" + name_ + "': " + what);
}

RoadNetwork NetworkReader::read(std::string_view xml) {
  pugi::xml_document document;
  const pugi::xml_parse_result result = document.load_buffer(xml.data(), xml.size());
  if (!result) {
    fail("not XML: " + std::string(result.description()) + " in line " +
         std::to_string(lineOfOffset(xml, result.offset)) + " (offset " +
         std::to_string(result.offset) + ")");
  }
  const pugi::xml_node net = document.child("net");
  if (!net) fail("no <net> element; a SUMO network (*.net.xml) was expected");
  if (net.attribute("lefthand").as_bool())
    fail("lefthand=\"true\": left-hand traffic is not supported");
  readLocation(net);
  for (const pugi::xml_node& edge : net.children("edge")) readEdge(edge);
  if (network_.lanes_.empty()) fail("no lanes; at least one <edge> with a <lane> was expected");
  for (const pugi::xml_node& junction : net.children("junction")) readJunction(junction);
  for (const pugi::xml_node& connection : net.children("connection")) readConnection(connection);
  continueInternalLanes();
  makeCenterlines();
  network_.index_ = std::make_unique<RoadNetwork::SpatialIndex>(network_.lanes_);
  return std::move(network_);
}

double NetworkReader::number(const pugi::xml_node& node, const char* attribute, double fallback,
                             const std::string& element) const {
  const pugi::xml_attribute found = node.attribute(attribute);
  if (!found) return fallback;
  const std::optional<double> value = core::parseNumber(found.value());
  if (!value) {
    fail(element + ": " + attribute + "=\"" + found.value() + "\" is not a finite number");
  }
  return *value;
}

std::vector<Eigen::Vector3d> NetworkReader::points(const std::string& text,
                                                   const std::string& element) const {
  std::vector<Eigen::Vector3d> shape;
  for (const std::string& word : core::splitText(text, ' ')) {
    const std::vector<std::string> parts = core::splitText(word, ',');
    if (parts.size() != 2 && parts.size() != 3) {
      fail(element + ": shape point \"" + word + "\"; x,y or x,y,z was expected");
    }
    Eigen::Vector3d point = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const std::optional<double> value = core::parseNumber(parts[i]);
      if (!value) fail(element + ": shape point \"" + word + "\" is not finite numbers");
      point[static_cast<Eigen::Index>(i)] = *value;
    }
    shape.push_back(point);
  }
  return shape;
}

/// What is farther away is a damaged number, and more than memory holds.
void NetworkReader::requireExtent(const std::vector<Eigen::Vector3d>& shape,
                                  const std::string& element) const {
  const Eigen::Vector3d& origin = shapes_.empty() ? shape.front() : shapes_.front().front();
  for (const Eigen::Vector3d& point : shape) {
    const Eigen::Vector3d offset = point - origin;
    if (offset.cwiseAbs().maxCoeff() <= kLargestExtent) continue;
    fail(element + ": the point " + core::formatNumber(point.x()) + "," +
         core::formatNumber(point.y()) + " lies more than " + core::formatNumber(kLargestExtent) +
         " m from the first lane; check its numbers");
  }
}

void NetworkReader::readLocation(const pugi::xml_node& net) {
  const std::string text = net.child("location").attribute("netOffset").value();
  if (text.empty()) return;
  const std::vector<Eigen::Vector3d> offset = points(text, "<location>, netOffset");
  if (offset.size() != 1) fail("<location>: netOffset=\"" + text + "\"; x,y was expected");
  network_.net_offset_ = offset.front().head<2>();
}

void NetworkReader::readEdge(const pugi::xml_node& edge) {
  const std::string id = edge.attribute("id").value();
  if (id.empty()) fail("an <edge> has no id");
  const auto first = static_cast<LaneIndex>(network_.lanes_.size());
  if (id.front() != ':') network_.edge_ids_.push_back(id);
  for (const pugi::xml_node& lane : edge.children("lane")) readLane(lane, edge);
  joinNeighbors(first);
}

void NetworkReader::readLane(const pugi::xml_node& node, const pugi::xml_node& edge) {
  Lane lane;
  lane.id = node.attribute("id").value();
  lane.edge_id = edge.attribute("id").value();
  if (lane.id.empty()) fail("a <lane> of edge '" + lane.edge_id + "' has no id");
  const std::string element = "lane '" + lane.id + "'";
  lane.index = static_cast<int>(number(node, "index", 0.0, element));
  lane.width = number(node, "width", lane.width, element);
  if (lane.width < 0.0 || lane.width > kLargestWidth) {
    fail(element + ": width=\"" + node.attribute("width").value() + "\"; 0 to " +
         core::formatNumber(kLargestWidth) + " m was expected");
  }
  // Ours follows from the shape, but SUMO drives by this one, and ends with a signal where it is
  // wrong.
  if (number(node, "length", 0.0, element) < 0.0)
    fail(element + ": length=\"" + node.attribute("length").value() + "\"; 0 m or more expected");
  lane.speed_limit = number(node, "speed", lane.speed_limit, element);
  lane.internal = lane.edge_id.front() == ':';
  lane.allows_cars = allowsCars(node);
  lane.routable = lane.allows_cars && lane.speed_limit >= kLowestRoutableSpeed;
  lane.junction_id =
      lane.internal ? junctionOfInternalEdge(lane.edge_id) : edge.attribute("to").value();
  std::vector<Eigen::Vector3d> shape = points(node.attribute("shape").value(), element);
  if (shape.size() < 2) fail(element + " has no shape; at least two points were expected");
  requireExtent(shape, element);
  const auto index = static_cast<LaneIndex>(network_.lanes_.size());
  if (!network_.lane_by_id_.emplace(lane.id, index).second) fail(element + " appears twice");
  shapes_.push_back(std::move(shape));
  network_.lanes_.push_back(std::move(lane));
}

void NetworkReader::joinNeighbors(LaneIndex first) {
  std::vector<Lane>& lanes = network_.lanes_;
  for (std::size_t i = static_cast<std::size_t>(first); i + 1 < lanes.size(); ++i) {
    if (lanes[i + 1].index != lanes[i].index + 1) continue;
    if (!lanes[i].allows_cars || !lanes[i + 1].allows_cars) continue;
    lanes[i].left = static_cast<LaneIndex>(i + 1);
    lanes[i + 1].right = static_cast<LaneIndex>(i);
  }
}

void NetworkReader::readJunction(const pugi::xml_node& node) {
  Junction junction;
  junction.id = node.attribute("id").value();
  junction.type = node.attribute("type").value();
  if (junction.type == "internal") return;
  const std::string element = "junction '" + junction.id + "'";
  junction.position = {number(node, "x", 0.0, element), number(node, "y", 0.0, element),
                       number(node, "z", 0.0, element)};
  junction.shape = points(node.attribute("shape").value(), element);
  requireExtent({junction.position}, element);
  requireExtent(junction.shape, element);
  network_.junctions_.push_back(std::move(junction));
}

LaneIndex NetworkReader::laneOf(const pugi::xml_node& connection, const char* edge,
                                const char* index, const std::string& element) const {
  const std::string id =
      std::string(connection.attribute(edge).value()) + "_" + connection.attribute(index).value();
  const LaneIndex lane = network_.findLane(id);
  if (lane == kNoLane) fail(element + ": unknown lane '" + id + "'");
  return lane;
}

void NetworkReader::readConnection(const pugi::xml_node& node) {
  const std::string element = "connection from '" + std::string(node.attribute("from").value()) +
                              "' to '" + node.attribute("to").value() + "'";
  const LaneIndex from = laneOf(node, "from", "fromLane", element);
  const LaneIndex to = laneOf(node, "to", "toLane", element);
  LaneLink connection;
  connection.to = to;
  connection.signal_id = node.attribute("tl").value();
  connection.signal_link = static_cast<int>(number(node, "linkIndex", -1.0, element));
  const std::string direction = node.attribute("dir").value();
  if (!direction.empty()) connection.direction = direction.front();
  const std::string state = node.attribute("state").value();
  if (!state.empty()) connection.state = state.front();
  const std::string via = node.attribute("via").value();
  if (!via.empty()) {
    connection.to = network_.findLane(via);
    if (connection.to == kNoLane) fail(element + ": unknown lane '" + via + "'");
    LaneLink exit;
    exit.to = to;
    exit.direction = connection.direction;
    via_exits_.emplace_back(connection.to, exit);
  }
  link(from, connection);
}

void NetworkReader::link(LaneIndex from, const LaneLink& connection) {
  std::vector<LaneLink>& next = network_.lanes_[static_cast<std::size_t>(from)].next;
  const auto same = [&](const LaneLink& known) { return known.to == connection.to; };
  if (std::any_of(next.begin(), next.end(), same)) return;
  next.push_back(connection);
  network_.lanes_[static_cast<std::size_t>(connection.to)].previous.push_back(from);
}

/// Internal lanes normally have connections of their own; where a file leaves them out, the
/// connection that passes through shows where they lead.
void NetworkReader::continueInternalLanes() {
  std::vector<bool> open(network_.lanes_.size());
  for (std::size_t i = 0; i < open.size(); ++i) open[i] = network_.lanes_[i].next.empty();
  for (const auto& [lane, exit] : via_exits_) {
    if (open[static_cast<std::size_t>(lane)]) link(lane, exit);
  }
  const auto by_lane = [](const LaneLink& left, const LaneLink& right) {
    return left.to < right.to;
  };
  for (Lane& lane : network_.lanes_) {
    std::sort(lane.next.begin(), lane.next.end(), by_lane);
    std::sort(lane.previous.begin(), lane.previous.end());
  }
}

double NetworkReader::headingAround(LaneIndex index) const {
  const Lane& lane = network_.lane(index);
  for (const LaneIndex previous : lane.previous) {
    const auto& shape = shapes_[static_cast<std::size_t>(previous)];
    if (!degenerate(shape)) return headingAtEnd(shape);
  }
  for (const LaneLink& next : lane.next) {
    const auto& shape = shapes_[static_cast<std::size_t>(next.to)];
    if (!degenerate(shape)) return startHeading(shape);
  }
  return 0.0;
}

/// netconvert writes internal lanes of no length where two edges touch: they become stubs of 1 cm.
void NetworkReader::makeCenterlines() {
  for (std::size_t i = 0; i < shapes_.size(); ++i) {
    std::vector<Eigen::Vector3d> shape = shapes_[i];
    if (degenerate(shape)) {
      const Eigen::Vector2d along = geometry::direction(headingAround(static_cast<LaneIndex>(i)));
      const Eigen::Vector3d start = shape.front();
      shape = {start, start + kDrawnLength * Eigen::Vector3d(along.x(), along.y(), 0.0)};
    }
    network_.lanes_[i].centerline = geometry::Polyline(shape);
  }
}

}  // namespace cdiff::map
