// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "e2e_cdiff/core/random.h"

namespace cdiff::suite {

// Road networks that are drawn at random, as sources of netconvert.

/// Draws one after the other from one key of a counter-based stream: the same stream and counter
/// give the same series.
class Draws {
 public:
  /// `counter` names what is drawn: a network, or a route of a suite.
  Draws(const core::RandomStream& random, std::uint32_t counter)
      : random_(random), key_{0, counter, 0} {}

  /// Uniform in [low, high).
  double uniform(double low, double high) { return random_.uniform(key_, element_++, low, high); }
  /// Uniform whole number in [low, high].
  int whole(int low, int high) {
    const auto count = static_cast<std::size_t>(high - low + 1);
    return low + static_cast<int>(random_.index(key_, element_++, count));
  }
  bool chance(double probability) { return uniform(0.0, 1.0) < probability; }
  /// -1 or 1.
  double sign() { return chance(0.5) ? 1.0 : -1.0; }
  template <class List>
  auto pick(const List& list) {
    return list[random_.index(key_, element_++, list.size())];
  }

 private:
  core::RandomStream random_;
  core::RandomKey key_;
  std::uint32_t element_ = 0;
};

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

// SUMO networks from drawn sources, by netconvert with networks/netconvert.netccfg.

/// Writes FOLDER/NAME.nod.xml, .edg.xml, .con.xml (where there are connections) and .net.xml;
/// answers the network's text, which is without netconvert's comment (date, version, paths): the
/// same sources and SUMO version give the same bytes. Throws InputError with netconvert's own words
/// when it fails.
std::string buildNetwork(const RoadPlan& plan, const std::filesystem::path& folder);

// Road networks drawn at random: crossings and T junctions, roundabouts, on-ramps, short districts;
// angles, lanes, limits, bends and elevation come from the draws (SI units, map frame).

/// What kind of junction or road a generated network consists of.
enum class NetworkKind { kCrossing, kRoundabout, kMerge, kDistrict };

/// What is given about a network; the draws decide the rest.
struct NetworkSpec {
  std::string name;
  NetworkKind kind = NetworkKind::kCrossing;
  int arms = 4;                      ///< arms of a crossing (3, 4) or a roundabout (3 to 5)
  int lanes = 1;                     ///< most lanes a direction (1 to 3; a roundabout 1 or 2)
  std::string control = "priority";  ///< priority, right_before_left or traffic_light
  bool elevation = false;            ///< whether roads climb or fall
};

RoadPlan drawNetwork(const NetworkSpec& spec, Draws& draws);

// The roads that lead to a junction.

/// Width of every lane [m], as in networks/netconvert.netccfg.
inline constexpr double kLaneWidth = 3.5;

/// Limits of small and of larger roads: 30 to 50 and 40 to 70 km/h [m/s].
double drawSmallSpeed(Draws& draws);
double drawLargeSpeed(Draws& draws);

/// How the roads of one junction bend: all to one side, so that they never meet again.
class ArmShape {
 public:
  ArmShape(bool elevation, Draws& draws) : side_(draws.sign()), elevation_(elevation) {}
  /// The middle of a road of some 110 to 240 m away from `start`: straight for its first 45 m, then
  /// often a bend that can be driven at `speed` [m/s] with 3 m/s^2 to the side.
  Line draw(const Eigen::Vector2d& start, double heading, double speed, Draws& draws) const;

 private:
  double side_;
  bool elevation_;
};

/// Both directions of a road: "NAME_in" toward the node `inner`, "NAME_out" away from it.
struct ArmPlan {
  std::string name;
  std::string inner;
  Line line;  ///< its middle, outwards
  int lanes = 1;
  double speed = 13.89;  ///< [m/s]
  int priority = 5;
};
/// Adds the two edges and the node at the road's end.
void addArm(const ArmPlan& arm, RoadPlan& plan);

}  // namespace cdiff::suite
