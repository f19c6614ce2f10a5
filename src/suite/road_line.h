// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The middle of a road, laid piece by piece from a place and heading: straights and arcs, then
/// lines beside it and heights on it (map frame, [m], [rad]).
#pragma once

#include <Eigen/Core>
#include <vector>

namespace cdiff::suite {

using Line = std::vector<Eigen::Vector3d>;

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

/// The line `offset` metres to the left (right: negative), with the same heights.
Line beside(const Line& line, double offset);
Line reversed(Line line);
/// Height 0 up to `begin` along the line, `height` at its end, level at both.
Line climbing(Line line, double begin, double height);
/// The part between two arc lengths of the line.
Line part(const Line& line, double begin, double end);
double lengthOf(const Line& line);

}  // namespace cdiff::suite
