// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The vehicles that we move in SUMO (moveToXY): keeps each one's SUMO route leading beyond the
/// next junction, so that other traffic yields to it, and hands vehicles over in both directions
/// without a jump.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "e2e_cdiff/simulation/driven_way.h"
#include "e2e_cdiff/simulation/settling_motion.h"
#include "e2e_cdiff/simulation/sumo_link.h"

namespace cdiff::simulation {

/// Its methods are called inside SumoLink::guarded.
class DrivenFleet {
 public:
  /// References must outlive the fleet. `match_threshold`: how far from a lane SUMO looks for one
  /// [m].
  DrivenFleet(SumoLink& link, const EdgeGraph& graph, double match_threshold)
      : link_(link), graph_(graph), match_threshold_(match_threshold) {}

  bool contains(const std::string& id) const { return vehicles_.count(id) != 0; }
  /// Adds a vehicle to SUMO that is moved from its first step on.
  void add(const DrivenVehicle& start, const traffic::VehicleDimensions& dimensions,
           const std::string& type_id);
  /// Takes over a vehicle that SUMO drives.
  void takeOver(const std::string& id, const traffic::VehicleDimensions& dimensions);
  /// Gives a vehicle back to SUMO; answers false, changing nothing, where it is on no lane of its
  /// direction.
  bool release(const DrivenVehicle& vehicle, const std::string& reported_lane);
  /// Forgets a vehicle without touching it.
  void forget(const std::string& id);
  /// Says where a vehicle will be after the coming step. `reported_lane`: SUMO's lane after the
  /// last step, empty off the road.
  void move(const DrivenVehicle& vehicle, const std::string& reported_lane);
  const traffic::VehicleDimensions& dimensions(const std::string& id) const {
    return vehicles_.at(id).way.dimensions();
  }
  /// To be called once a step [s]: moves released vehicles into the middle of their lane, and later
  /// allows lane changes again.
  void advance(double step);
  /// Speeds [m/s] of released vehicles that are still moved into their lane; SUMO's own figure for
  /// them is a quotient of places on lanes.
  std::map<std::string, double> settlingSpeeds() const;

 private:
  struct Moved {
    DrivenWay way;
    std::vector<int> given;     ///< edges of its SUMO route, from the edge where it was set
    bool on_way = false;        ///< on the lanes of that route: SUMO keeps it (keepRoute 3)
    bool outdated = false;      ///< a better way is to be given
    std::string refused_lane;   ///< lane on which SUMO refused the last way
    int last_edge = kNoEdge;    ///< SUMO's edge after the last step
    bool moved_on_way = false;  ///< whether the last move kept the route
    map::LaneIndex blind_lane = map::kNoLane;  ///< lane that SUMO does not find with the route kept
  };
  struct Released {
    SettlingMotion motion;
    bool settling = true;       ///< SUMO decides its speed, we its place
    bool first = true;          ///< the step after the release
    double speed_before = 0.0;  ///< a step before that of `motion` [m/s]
    double left = 0.0;          ///< until lane changes are allowed again [s]
  };
  void moveFront(const std::string& id, const Eigen::Vector2d& front, double heading, bool on_way);
  void settle(const std::string& id, Released& released, double step);
  void updateWay(const std::string& id, Moved& moved, const FrontPlace& place,
                 const std::string& reported_lane);
  static void loseWay(Moved& moved);
  /// Of several ways through a junction between the same two edges SUMO considers one when it keeps
  /// the route: on the others the vehicle would be on no lane, seen by nobody.
  static void avoidBlindLane(Moved& moved, const FrontPlace& place,
                             const std::string& reported_lane);
  bool giveWay(const std::string& id, Moved& moved, const std::vector<int>& way);
  int edgeOf(const std::string& lane_id) const;

  SumoLink& link_;
  const EdgeGraph& graph_;
  double match_threshold_;
  std::map<std::string, Moved> vehicles_;
  std::map<std::string, Released> released_;
  std::uint64_t added_ = 0;
};

}  // namespace cdiff::simulation
