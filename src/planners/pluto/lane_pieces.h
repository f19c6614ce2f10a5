// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "e2e_cdiff/map/road_network.h"

namespace cdiff::planners {

inline constexpr std::int64_t kPiecePoints = 20;    ///< of a piece, evenly spaced
inline constexpr std::int64_t kPieceChannels = 10;  ///< of a point

/// Part of a lane, at most 50 m long, as a map polygon of Pluto: 20 points of the center line with
/// those of both borders, in the frame of its middle.
struct LanePiece {
  map::LaneIndex lane = map::kNoLane;
  geometry::Pose2d pose;   ///< its middle, along the lane (map frame)
  double elevation = 0.0;  ///< there [m]
  double reach = 0.0;      ///< largest distance of a point from there [m]
  /// By point, in the frame of `pose`: center / 10 m, step to the next center [m], cos and sin of
  /// the heading, left and right border less center [m].
  std::array<float, kPiecePoints * kPieceChannels> points{};
  std::array<Eigen::Vector2d, kPiecePoints> centers{};  ///< map frame [m]
  std::string signal;  ///< light that controls the way onto the lane; empty: none
  int link = -1;       ///< position in its state text
};

/// The lanes of a network that allow cars, cut into pieces; shorter ones than 1 m are left out.
class LanePieces {
 public:
  explicit LanePieces(const map::RoadNetwork& network);

  const std::vector<LanePiece>& all() const { return pieces_; }
  /// Numbers of the pieces that pass within `radius` [m] of a place on its level, the `most`
  /// nearest, nearest first, ties by number.
  std::vector<std::uint32_t> near(const Eigen::Vector2d& position, double elevation, double radius,
                                  std::size_t most) const;

 private:
  std::vector<LanePiece> pieces_;
};

}  // namespace cdiff::planners
