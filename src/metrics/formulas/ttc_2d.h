// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <optional>

#include "e2e_cdiff/geometry/shapes.h"
#include "e2e_cdiff/metrics/metric.h"

namespace cdiff::metrics {

// Time to collision in the plane [s] of two boxes (map frame) that keep their velocities and
// headings: the paper's 2D-TTC, t = min { t >= 0 : A + v_A t touches B + v_B t }, with RIFT's
// ray-cast variant and the paper's own wording beside it.

/// A box with a constant velocity.
struct MovingBox {
  geometry::OrientedBox box;
  Eigen::Vector2d velocity = Eigen::Vector2d::Zero();  ///< map frame [m/s]
};

/// Time of first contact, exact (swept separating axes). 0 when the boxes overlap now; nullopt when
/// they never touch or a value is not finite.
std::optional<double> timeToCollision2d(const MovingBox& first, const MovingBox& second);

/// Order in which a ray cast joins a box's corners to an outline.
enum class OutlineOrder {
  kRing,   ///< FL, FR, RR, RL: the box
  kBowTie  ///< FL, FR, RL, RR as in RIFT's code: the diagonals instead of the long sides
};

/// The ray cast behind RIFT's RTTC, not rounded [s]: exact with kRing where the boxes approach.
std::optional<double> rayCastTimeToCollision(const MovingBox& first, const MovingBox& second,
                                             OutlineOrder order);

/// RIFT's RTTC: nullopt unless the boxes approach (-u . (v_B - v_A) >= 0 with u from A to B); else
/// the shortest ray from a corner along the relative velocity onto the other's outline, divided by
/// the relative speed and rounded to 0.01 s. The outline is RIFT's bow-tie FL, FR, RL, RR: the long
/// sides are never tested, the diagonals are.
std::optional<double> riftTimeToCollision(const MovingBox& first, const MovingBox& second);

/// RIFT's ACT [s], rounded to 0.01 s: shortest distance from a corner of one box to a corner of the
/// other / speed at which the centers approach; nullopt unless they do.
std::optional<double> riftApproachTime(const MovingBox& first, const MovingBox& second);

/// The paper's wording: minimum of longitudinal and lateral time to collision in the first box's
/// frame, boxes taken as parallel. T_lon = (|d_lon| - (l_A + l_B) / 2) / closing speed, valid where
/// |d_lat + v_lat T_lon| <= (w_A + w_B) / 2; T_lat likewise. 0 when both gaps are closed now;
/// nullopt when neither is valid.
std::optional<double> longitudinalLateralTimeToCollision(const MovingBox& first,
                                                         const MovingBox& second);

// The ego against the vehicles around it at one tick: smallest times to collision [s] and distance
// between boxes [m].

/// Which times to collision are computed, and up to which distance [m] and time [s].
struct InteractionOptions {
  double radius = 60.0;        ///< largest distance of centers for times to collision [m]
  double time_limit = 3600.0;  ///< a longer time counts as never [s]
  bool variants = false;       ///< whether ttc_lon_lat, rift_ttc and rift_act are computed
};

/// `ego` is one of the snapshot's vehicles. Vehicles with a value that is not finite are passed
/// over.
Interaction interactionOf(const traffic::Vehicle& ego, const traffic::TrafficSnapshot& snapshot,
                          const InteractionOptions& options);

}  // namespace cdiff::metrics
