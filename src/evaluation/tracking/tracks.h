// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "e2e_cdiff/core/random.h"
#include "e2e_cdiff/geometry/shapes.h"
#include "e2e_cdiff/traffic/vehicle.h"

namespace cdiff::evaluation {

/// A drawn course on which trackers of plans are tried: the center line of a lane of 3.5 m (map
/// frame, m), how fast it is to be driven, and where the vehicle starts. It belongs to no network
/// of any suite.
struct Track {
  std::string kind;  ///< one of trackKinds()
  geometry::Polyline line;
  double speed = 8.0;           ///< before the stop [m/s]
  double acceleration = 1.0;    ///< from a standing start [m/s^2]
  Eigen::Index plan_rows = 80;  ///< of each plan, 0.1 s apart
  traffic::VehicleState start;
  std::uint32_t number = 0;  ///< of the track among those drawn with it

  /// Where it is to stop, 5 m before the end of the line, so that the box stays beside the line
  /// [m].
  double stop() const;
  /// Speed at a place of the line [m/s]: up to `speed` by `acceleration`, then an even stop (2
  /// m/s^2).
  double speedAt(double arc_length) const;
  /// Time that this takes at most from start to stop [s].
  double duration() const;
};

/// straight, left, right, s_curve, roundabout.
const std::vector<std::string>& trackKinds();

/// `each` tracks of every kind. Speeds of 4 to 9 m/s (straight: 14 m/s); radii of 5 to 11 m to the
/// right, 7 to 16 m to the left, 10 to 40 m in an S; starts at that speed or, one in two, standing
/// (0.5 to 2 m/s^2), up to 0.4 m and 0.1 rad off the line; plans of 8 s and of 3.2 s by turns.
std::vector<Track> drawTracks(const core::RandomStream& random, int each);

/// The plan of a driver who knows the line, in the body frame of `state` [rows, 2]: from the
/// nearest place of the line (`arc_length`) on, at speedAt. It is beside the line by e0 + e1 t to
/// the left, e0 ~ N(0, 0.05 m), e1 ~ N(0, 0.1 m/s) by decision, as plans of networks are.
Eigen::MatrixX2d planOn(const Track& track, const traffic::VehicleState& state, double arc_length,
                        const core::RandomStream& random, std::uint32_t decision);

}  // namespace cdiff::evaluation
