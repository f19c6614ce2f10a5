// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "e2e_cdiff/map/road_network.h"
#include "e2e_cdiff/map/route.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"

namespace cdiff::metrics {

/// Whether braking alone would have spared the ego a contact (map frame, SI units;
/// docs/metrics.md).
///
/// The ego's swept path at a tick: its own box, and the strip of its width along its route from its
/// center to as far before its front as it comes at its speed v in the time that it needs to stop,
///
///     reach = v (t_r + v / b),   t_r = 0.5 s, b = 6 m/s^2
///
/// (straight ahead without a route, or more than 2 m off it). The other has entered it at t_0, the
/// first tick of the last unbroken run of ticks up to the contact at which its box touches it. The
/// ego brakes from the first tick t_b >= t_0 + t_r on: it stays on the path that it drove, and has
/// come along it by
///
///     s(t) = min(s as driven, s(t_b) + v_b tau - b tau^2 / 2),   tau = min(t - t_b, v_b / b)
///
/// (after the contact straight ahead). The other keeps its poses up to the contact and then its
/// velocity. It is avoided: t_b is before the contact, and the boxes overlap at no tick from t_b
/// until the contact or, where that is later, until the ego stands.
class BrakingAvoidance {
 public:
  /// The route must outlive the object; it may be empty.
  explicit BrakingAvoidance(const map::Route& ego_route) : route_(ego_route) {}

  /// Ticks in order; `ego_arc_length` is about where the ego is on its route [m].
  void observe(const traffic::TrafficSnapshot& snapshot, double ego_arc_length);
  /// Of a contact of the ego with this vehicle at the last observed tick.
  bool avoids(const std::string& partner) const;

 private:
  struct EgoPlace {
    double time = 0.0;
    geometry::OrientedBox box;
    double speed = 0.0;
    double distance = 0.0;  ///< driven since the first kept place [m]
  };
  /// A vehicle that is in the ego's swept path.
  struct Intruder {
    std::size_t entered = 0;  ///< index of that tick in places_
    std::vector<geometry::OrientedBox> boxes;
    Eigen::Vector2d velocity = Eigen::Vector2d::Zero();  ///< at the last tick [m/s]
  };

  std::vector<geometry::OrientedBox> sweptPath(const traffic::Vehicle& ego,
                                               double ego_arc_length) const;
  void follow(const traffic::TrafficSnapshot& snapshot, const traffic::Vehicle& ego,
              const std::vector<geometry::OrientedBox>& swept);
  void place(double time, const traffic::Vehicle& ego);
  std::size_t brakingPlace(const Intruder& intruder) const;
  /// The ego's box after a distance on the path that it drove.
  geometry::OrientedBox boxAt(double distance) const;
  double brakedDistance(std::size_t braking, double time) const;
  bool meetsUntilContact(const Intruder& intruder, std::size_t braking) const;
  bool meetsAfterContact(const Intruder& intruder, std::size_t braking) const;

  const map::Route& route_;
  std::vector<EgoPlace> places_;  ///< since the oldest intruder entered
  std::map<std::string, Intruder> intruders_;
};

}  // namespace cdiff::metrics
