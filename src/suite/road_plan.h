// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace cdiff::suite {

/// A node of a planned network, map frame [m].
struct PlanNode {
  std::string id;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< [m]
  std::string type;  ///< priority, right_before_left, traffic_light; empty at the end of a road
};

/// A directed road of a planned network, map frame [m].
struct PlanEdge {
  std::string id;
  std::string from;
  std::string to;
  int lanes = 1;
  double speed = 13.89;  ///< limit [m/s]
  int priority = 5;
  std::vector<Eigen::Vector3d> shape;  ///< [m]; empty: straight from node to node
  bool centered = false;               ///< whether the shape is the edge's middle, else its left
};

/// A connection from a lane of one edge to a lane of the next, by edge ids.
struct PlanConnection {
  std::string from;
  std::string to;
  int from_lane = 0;
  int to_lane = 0;
  bool far_view = false;  ///< onto a roundabout: the ring is seen from 15 m
};

/// The nodes and edges that make a roundabout.
struct PlanRoundabout {
  std::vector<std::string> nodes;
  std::vector<std::string> edges;
};

/// Edges in driving order that a route may take.
struct PlannedPath {
  std::vector<std::string> edges;
  std::string purpose;  ///< roundabout or merge; empty: follows from the angle it turns
};

/// A road network as netconvert's plain-XML sources describe it: nodes, edges with their lines in
/// the map frame [m], connections, and the paths through it that a route may take.
struct RoadPlan {
  std::string name;
  std::string text;  ///< one sentence about what was drawn
  std::vector<PlanNode> nodes;
  std::vector<PlanEdge> edges;
  std::vector<PlanConnection> connections;  ///< the others are netconvert's
  std::vector<PlanRoundabout> roundabouts;
  std::vector<PlannedPath> paths;
};

/// The plain-XML sources; coordinates with two decimals. No connections: an empty text.
std::string nodesXml(const RoadPlan& plan);
std::string edgesXml(const RoadPlan& plan);
std::string connectionsXml(const RoadPlan& plan);

using Line = std::vector<Eigen::Vector3d>;

/// The middle of a road, laid piece by piece from a place and heading: straights and arcs, then
/// lines beside it and heights on it (map frame, [m], [rad]).
class RoadLine {
 public:
  RoadLine(const Eigen::Vector2d& start, double heading);
  /// Points every 5 m.
  RoadLine& straight(double length);
  /// `angle` positive to the left; points every 1 m.
  RoadLine& arc(double radius, double angle);
  const Line& points() const { return points_; }
  double heading() const { return heading_; }

 private:
  Eigen::Vector2d position_;
  double heading_;
  Line points_;
};

/// The line `offset` meters to the left (right: negative), with the same heights.
Line beside(const Line& line, double offset);
Line reversed(Line line);
/// Height 0 up to `begin` along the line, `height` at its end, level at both.
Line climbing(Line line, double begin, double height);
/// The part between two arc lengths of the line.
Line part(const Line& line, double begin, double end);
double lengthOf(const Line& line);

}  // namespace cdiff::suite
