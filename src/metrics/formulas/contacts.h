// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "e2e_cdiff/map/road_network.h"
#include "e2e_cdiff/map/route.h"
#include "e2e_cdiff/metrics/metric.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"

namespace cdiff::metrics {

/// One of the two vehicles of a contact.
struct ContactParty {
  std::optional<traffic::VehicleState> before;  ///< at the tick before; absent: it was not there
  traffic::VehicleState now;                    ///< at the first tick with overlap
  traffic::VehicleDimensions dimensions;
  std::optional<double> lane_heading;  ///< heading of its own lane [rad]

  /// The box at a share in [0, 1] of the tick that led to the overlap.
  geometry::OrientedBox boxAt(double share) const;
  /// Velocity over the tick of the body's point that is at `point` at that share [m/s].
  Eigen::Vector2d velocityAt(const Eigen::Vector2d& point, double share, double step) const;
};

/// Whether the ego is at fault in a contact, with the facts that decide it: who strikes whom, from
/// the motion of the two boxes over the tick in which they meet (map frame, SI units;
/// docs/protocols.md).
///
/// The poses are interpolated between the tick before and the first tick with overlap, and the
/// instant of first touch is found by bisection. There, the contact normal n (from the ego to the
/// other) is the axis of either box along which they overlap least, and the contact point p is the
/// mean of the corners that lie in both. Closing speeds: of the ego v_e(p) n, of the other
/// -v_o(p) n, where v(p) is the velocity of the body's point at p over the tick, turning and
/// sideways jumps included. The one that closes faster strikes the other:
///
///     ego at fault  <=>  v_e(p) n >= -v_o(p) n          (a tie is the ego's: it is judged)
///
/// So a striker from behind is at fault, as is the front that runs into a flank. Exceptions, in
/// this order: a vehicle that was not there at the tick before strikes; a standing ego is never at
/// fault; head-on, the one that is on no lane of its direction is at fault, where the other is on
/// one; side by side in the same direction, n is taken perpendicular to the lane, so that the one
/// that moves sideways is at fault and not the one whose corner is touched.
struct ContactFault {
  bool ego_at_fault = false;
  std::string reason;      ///< a short sentence without subject "contact"
  std::string ego_side;    ///< "front", "rear", "left side" or "right side"
  std::string other_side;  ///< side of the other vehicle
  Eigen::Vector2d point = Eigen::Vector2d::Zero();  ///< point of contact, map frame [m]
};

/// `step` is the time between the two ticks [s]; an ego slower than `standing_speed` [m/s] stands.
ContactFault judgeContact(const ContactParty& ego, const ContactParty& other, double step,
                          double standing_speed);

/// Judges every contact of the ego from snapshots in order.
class EgoContacts {
 public:
  /// `network` (nullptr: no lane is known) must outlive the object.
  EgoContacts(const map::RoadNetwork* network, double standing_speed)
      : network_(network), standing_speed_(standing_speed) {}

  void observe(const traffic::TrafficSnapshot& snapshot);
  const std::vector<EgoContact>& contacts() const { return contacts_; }
  /// Id of the vehicle at fault in a contact of this snapshot, by the same rule with `judged` in
  /// the ego's place; empty where a position is missing. Call before observe().
  std::string strikerOf(const traffic::TrafficSnapshot& snapshot, const std::string& judged,
                        const std::string& other) const;

 private:
  ContactParty partyOf(const traffic::Vehicle& vehicle) const;
  void add(const traffic::TrafficSnapshot& snapshot, const traffic::Vehicle& ego,
           const std::string& partner);

  const map::RoadNetwork* network_;
  double standing_speed_;
  std::vector<traffic::Vehicle> before_;  ///< at the last snapshot
  double time_before_ = 0.0;              ///< [s]
  std::vector<EgoContact> contacts_;
};

/// Whether the ego could have avoided a contact by braking (map frame, SI units; docs/metrics.md).
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
/// velocity. Avoidable: t_b is before the contact, and the boxes overlap at no tick from t_b until
/// the contact or, where that is later, until the ego stands.
class ContactAvoidance {
 public:
  /// The route must outlive the object; it may be empty.
  explicit ContactAvoidance(const map::Route& ego_route) : route_(ego_route) {}

  /// Ticks in order; `ego_arc_length` is about where the ego is on its route [m].
  void observe(const traffic::TrafficSnapshot& snapshot, double ego_arc_length);
  /// Of a contact of the ego with this vehicle at the last observed tick.
  bool avoidable(const std::string& partner) const;

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
