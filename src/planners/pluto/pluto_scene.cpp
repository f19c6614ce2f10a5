// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/pluto/pluto_scene.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "e2e_cdiff/core/angle.h"
#include "traffic/vehicle_class.h"

namespace cdiff::planners {
namespace {

// What a number of 1 stands for.
constexpr double kPlutoPlaceScale = 80.0;        // [m]
constexpr double kPlutoLineScale = 20.0;         // [m]
constexpr double kPlutoOwnScale = 10.0;          // [m]
constexpr double kPlutoExtentScale = 10.0;       // [m]
constexpr double kPlutoSpeedScale = 10.0;        // [m/s]
constexpr double kPlutoAccelerationScale = 4.0;  // [m/s^2]
constexpr double kPlutoLimitScale = 15.0;        // [m/s]

/// A vector of the map frame in the directions of the vehicle's.
Eigen::Vector2d turned(const geometry::Pose2d& frame, const Eigen::Vector2d& vector) {
  const Eigen::Vector2d forward = geometry::direction(frame.heading);
  return {forward.dot(vector), geometry::leftNormal(forward).dot(vector)};
}

/// What changed from one decision to the next.
void addDifference(const geometry::Pose2d& frame, const TrackPoint& before, const TrackPoint& after,
                   const traffic::VehicleDimensions& size, float* row) {
  const Eigen::Vector2d place = turned(frame, after.state.position - before.state.position);
  const Eigen::Vector2d speed = turned(frame, after.state.velocity() - before.state.velocity());
  const double turn = after.state.heading - before.state.heading;
  const std::array<double, kAgentChannels> values = {place.x(),
                                                     place.y(),
                                                     speed.x(),
                                                     speed.y(),
                                                     std::cos(turn),
                                                     std::sin(turn),
                                                     size.width / kPlutoExtentScale,
                                                     size.length / kPlutoExtentScale,
                                                     1.0};
  std::transform(values.begin(), values.end(), row,
                 [](double value) { return static_cast<float>(value); });
}

PlutoAgent agentOf(const PlutoMoment& moment, const TrackPoint& now) {
  const geometry::Pose2d frame = moment.point().state.pose();
  const traffic::VehicleDimensions& size = moment.vehicles->size(now.vehicle);
  PlutoAgent agent;
  agent.vehicle = now.vehicle;
  agent.kind = static_cast<std::uint8_t>(traffic::classOf(size));
  agent.pose = plutoPose(frame, now.state.pose());
  const TrackPoint* after = &now;
  const std::size_t differences =
      std::min(moment.frames.size() - 1, static_cast<std::size_t>(kPlutoHistory));
  for (std::size_t i = 0; i < differences && after != nullptr; ++i) {
    const TrackPoint* before = moment.frames[moment.frames.size() - 2 - i]->find(now.vehicle);
    const std::size_t row = static_cast<std::size_t>(kPlutoHistory) - 1 - i;
    if (before != nullptr)
      addDifference(frame, *before, *after, size, &agent.history[row * kAgentChannels]);
    after = before;
  }
  return agent;
}

/// Edges of the route from the vehicle's place on, and lanes of its junctions.
struct RouteAhead {
  std::set<std::string> edges;
  std::set<map::LaneIndex> lanes;

  bool holds(const map::RoadNetwork& network, map::LaneIndex lane) const {
    return network.lane(lane).internal ? lanes.count(lane) != 0
                                       : edges.count(network.lane(lane).edge_id) != 0;
  }
};

RouteAhead plutoRouteAhead(const map::RoadNetwork& network, const map::Route& route,
                           double arc_length) {
  RouteAhead ahead;
  const std::vector<double>& places = route.path().arcLengths();
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (i + 1 < places.size() && places[i + 1] < arc_length) continue;
    ahead.lanes.insert(route.lanes()[i]);
    ahead.edges.insert(network.lane(route.lanes()[i]).edge_id);
  }
  return ahead;
}

}  // namespace

PlutoPose plutoPose(const geometry::Pose2d& frame, const geometry::Pose2d& pose) {
  const Eigen::Vector2d place = frame.toBody(pose.position);
  return {static_cast<float>(place.x() / kPlutoPlaceScale),
          static_cast<float>(place.y() / kPlutoPlaceScale),
          static_cast<float>(core::angleDifference(pose.heading, frame.heading) / core::kPi)};
}

LightState lightState(const std::vector<traffic::SignalState>& signals, const LanePiece& piece) {
  if (piece.signal.empty() || piece.link < 0) return LightState::kNone;
  for (const traffic::SignalState& signal : signals) {
    if (signal.id != piece.signal) continue;
    const auto link = static_cast<std::size_t>(piece.link);
    const char letter = link < signal.state.size() ? signal.state[link] : 'o';
    if (letter == 'g' || letter == 'G') return LightState::kGreen;
    if (letter == 'y' || letter == 'Y' || letter == 'u') return LightState::kYellow;
    return letter == 'r' || letter == 'R' ? LightState::kRed : LightState::kNone;
  }
  return LightState::kNone;
}

PlutoLine plutoLine(const geometry::Pose2d& frame, const ReferenceLine& line) {
  PlutoLine token;
  const geometry::Pose2d& first = line.poses.front();
  token.pose = plutoPose(frame, first);
  for (std::size_t i = 0; i < line.poses.size(); i += kLineTokenStride) {
    const geometry::Pose2d& pose = line.poses[i];
    const std::size_t next = std::min(i + kLineTokenStride, line.poses.size() - 1);
    const Eigen::Vector2d place = first.toBody(pose.position);
    const Eigen::Vector2d seen = frame.toBody(pose.position);
    const Eigen::Vector2d step = turned(first, line.poses[next].position - pose.position);
    const double heading = pose.heading - first.heading;
    for (const double value :
         {place.x() / kPlutoLineScale, place.y() / kPlutoLineScale, step.x() / kLineTokenStride,
          step.y() / kLineTokenStride, std::cos(heading), std::sin(heading),
          seen.x() / kPlutoOwnScale, seen.y() / kPlutoOwnScale})
      token.points.push_back(static_cast<float>(value));
  }
  return token;
}

PlutoSceneBuilder::PlutoSceneBuilder(const PlutoArchitecture& architecture,
                                     const map::RoadNetwork& network)
    : architecture_(architecture), network_(network), pieces_(network) {}

std::vector<ReferenceLine> PlutoSceneBuilder::linesOf(const PlutoMoment& moment) const {
  return referenceLines(network_, *moment.route, moment.arc_length, moment.point().state,
                        static_cast<std::size_t>(architecture_.lines));
}

PlutoInput PlutoSceneBuilder::inputOf(const PlutoMoment& moment,
                                      const std::vector<ReferenceLine>& lines) const {
  const TrackPoint& own = moment.point();
  PlutoInput input;
  input.motion = {static_cast<float>(own.state.speed / kPlutoSpeedScale),
                  static_cast<float>(own.acceleration / kPlutoAccelerationScale), own.steer};
  input.agents = agentsOf(moment);
  input.polygons = polygonsOf(moment);
  for (const ReferenceLine& line : lines) input.lines.push_back(plutoLine(own.state.pose(), line));
  return input;
}

std::vector<PlutoAgent> PlutoSceneBuilder::agentsOf(const PlutoMoment& moment) const {
  const traffic::VehicleState& own = moment.point().state;
  std::vector<std::pair<double, const TrackPoint*>> near;
  for (const TrackPoint& point : moment.frames.back()->points) {
    const bool level = !traffic::onDifferentLevels(point.state.elevation, own.elevation);
    const double distance = (point.state.position - own.position).norm();
    if (point.vehicle != moment.own && level && distance <= architecture_.radius)
      near.emplace_back(distance, &point);
  }
  std::sort(near.begin(), near.end(), [&](const auto& left, const auto& right) {
    if (left.first != right.first) return left.first < right.first;
    return moment.vehicles->id(left.second->vehicle) < moment.vehicles->id(right.second->vehicle);
  });
  const auto most = static_cast<std::size_t>(architecture_.agents);
  if (near.size() > most) near.resize(most);
  std::vector<PlutoAgent> agents;
  for (const auto& [distance, point] : near) agents.push_back(agentOf(moment, *point));
  return agents;
}

std::vector<PlutoPolygon> PlutoSceneBuilder::polygonsOf(const PlutoMoment& moment) const {
  const traffic::VehicleState& own = moment.point().state;
  const RouteAhead ahead = plutoRouteAhead(network_, *moment.route, moment.arc_length);
  std::vector<PlutoPolygon> polygons;
  for (const std::uint32_t number :
       pieces_.near(own.position, own.elevation, architecture_.radius,
                    static_cast<std::size_t>(architecture_.polygons))) {
    const LanePiece& piece = pieces_.all()[number];
    const map::Lane& lane = network_.lane(piece.lane);
    const double limit = std::min(lane.speed_limit, moment.target_speed);
    PlutoPolygon polygon;
    polygon.piece = number;
    polygon.pose = plutoPose(own.pose(), piece.pose);
    polygon.internal = lane.internal ? 1 : 0;
    polygon.on_route = ahead.holds(network_, piece.lane) ? 1 : 0;
    polygon.light = static_cast<std::uint8_t>(lightState(*moment.signals, piece));
    polygon.limit = static_cast<float>(limit / kPlutoLimitScale);
    polygons.push_back(polygon);
  }
  return polygons;
}

}  // namespace cdiff::planners
