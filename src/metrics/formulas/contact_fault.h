// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "e2e_cdiff/map/road_network.h"
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

}  // namespace cdiff::metrics
