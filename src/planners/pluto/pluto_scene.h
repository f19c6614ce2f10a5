// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "e2e_cdiff/map/route.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"
#include "planners/pluto/lane_pieces.h"
#include "planners/pluto/pluto_weights.h"
#include "planners/pluto/reference_lines.h"
#include "planners/pluto/tracks.h"

namespace cdiff::planners {

inline constexpr std::int64_t kAgentChannels = 9;     ///< of a difference
inline constexpr std::int64_t kLineChannels = 8;      ///< of a point of a reference line
inline constexpr std::int64_t kLineTokenPoints = 41;  ///< at most: one every 3 m
inline constexpr std::size_t kLineTokenStride = 3;    ///< [m]
inline constexpr std::int64_t kAgentKinds = 3;        ///< traffic::VehicleClass
inline constexpr std::int64_t kLightStates = 4;       ///< LightState
inline constexpr std::int64_t kPoseNumbers = 3;
inline constexpr std::int64_t kMotionNumbers = 3;

/// x / 80 m, y / 80 m, heading / pi in the vehicle's frame.
using PlutoPose = std::array<float, kPoseNumbers>;

PlutoPose plutoPose(const geometry::Pose2d& frame, const geometry::Pose2d& pose);

/// A vehicle near the controlled one, in the latter's frame. By decision, oldest first: what place
/// [m], velocity [m/s] and heading (cos, sin) changed by, width / 10 m, length / 10 m, and 1; all 0
/// where it was not seen at both ends.
struct PlutoAgent {
  PlutoPose pose;
  std::array<float, kPlutoHistory * kAgentChannels> history{};
  std::uint8_t kind = 0;      ///< traffic::VehicleClass
  std::uint32_t vehicle = 0;  ///< number in the VehicleTable
};

/// What a light shows to the lane that it lets in.
enum class LightState : std::uint8_t { kNone = 0, kGreen = 1, kYellow = 2, kRed = 3 };

LightState lightState(const std::vector<traffic::SignalState>& signals, const LanePiece& piece);

/// A piece of a lane, placed in the controlled vehicle's frame.
struct PlutoPolygon {
  std::uint32_t piece = 0;  ///< number in LanePieces
  PlutoPose pose;
  std::uint8_t internal = 0;  ///< 1: inside a junction
  std::uint8_t on_route = 0;  ///< 1: its edge is on the route ahead
  std::uint8_t light = 0;     ///< LightState
  float limit = 0.0F;         ///< lower of the lane's limit and the driver's target speed / 15 m/s
};

/// A reference line in the frame of its first pose: place / 20 m, step to the next point [m] / 3,
/// cos and sin of the heading; and place in the vehicle's frame / 10 m.
struct PlutoLine {
  PlutoPose pose;             ///< of its first point, in the vehicle's frame
  std::vector<float> points;  ///< [n, kLineChannels], every 3 m
};

/// What the network is given of a moment (Pluto, Cheng et al. 2024, III; docs/pluto.md).
struct PlutoInput {
  std::array<float, kMotionNumbers> motion{};  ///< speed / 10 m/s, acceleration / 4 m/s^2, steer
  std::vector<PlutoAgent> agents;              ///< nearest first
  std::vector<PlutoPolygon> polygons;          ///< nearest first
  std::vector<PlutoLine> lines;                ///< at least one
};

/// A moment of one vehicle, as recorded (map frame, SI units).
struct PlutoMoment {
  std::vector<const TrackFrame*> frames;  ///< up to now, oldest first; every state finite
  const VehicleTable* vehicles = nullptr;
  std::uint32_t own = 0;
  const map::Route* route = nullptr;
  double arc_length = 0.0;  ///< place on the route [m]
  double target_speed = 8.0;
  const std::vector<traffic::SignalState>* signals = nullptr;

  const TrackPoint& point() const { return *frames.back()->find(own); }
};

/// Makes the network's inputs on one road network, which must outlive it.
class PlutoSceneBuilder {
 public:
  PlutoSceneBuilder(const PlutoArchitecture& architecture, const map::RoadNetwork& network);

  PlutoInput inputOf(const PlutoMoment& moment, const std::vector<ReferenceLine>& lines) const;
  std::vector<ReferenceLine> linesOf(const PlutoMoment& moment) const;
  const LanePieces& pieces() const { return pieces_; }
  const map::RoadNetwork& network() const { return network_; }

 private:
  std::vector<PlutoAgent> agentsOf(const PlutoMoment& moment) const;
  std::vector<PlutoPolygon> polygonsOf(const PlutoMoment& moment) const;

  PlutoArchitecture architecture_;
  const map::RoadNetwork& network_;
  LanePieces pieces_;
};

PlutoLine plutoLine(const geometry::Pose2d& frame, const ReferenceLine& line);

}  // namespace cdiff::planners
