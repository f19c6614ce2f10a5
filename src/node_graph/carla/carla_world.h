// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "e2e_cdiff/cbv/cbv_selection.h"
#include "node_graph/carla/carla_link.h"
#include "session/protocol.h"
#include "session/session_setup.h"

namespace cdiff::node_graph {

/// Source of faults that the bridge is to blame for.
inline constexpr const char* kCarlaBridge = "carla_bridge";

/// The world of a session that CARLA simulates: makes the snapshots of a session from the bridge's
/// frames (network's frame, SI units), finds contacts, and follows the protocol's end rules.
/// Decides nothing. Nobody is removed after a contact.
class CarlaWorld {
 public:
  /// Both must outlive the object.
  CarlaWorld(const session::SessionSetup& setup, const CarlaLink& link);

  const traffic::TrafficSnapshot& snapshot() const { return snapshot_; }
  /// Makes the snapshot of the next frame. `superseded`: the bridge has gone on, so nothing is
  /// decided. Frames that did not come are a recorded fault. Throws SimulatorError when CARLA's
  /// time does not go on by whole steps.
  void take(const CarlaFrame& frame, bool superseded);
  /// Who is a CBV from the next frame on.
  void assign(const cbv::CbvSelection& selection);
  /// Records a fault that was survived; shown in the next snapshot.
  void recordFault(const std::string& source, const std::string& text);
  /// The next snapshot is the present one with this status and fault.
  void end(traffic::SessionStatus status, const std::string& source, const std::string& text);
  /// Frames that did not come.
  std::uint64_t lostFrames() const { return lost_; }

 private:
  void advanceTo(const ros::Time& stamp);
  void collectVehicles(const CarlaFrame& frame);
  void addMotion(traffic::Vehicle& vehicle, double seconds) const;
  std::vector<traffic::Contact> newContacts();

  const session::SessionSetup& setup_;
  const CarlaLink& link_;
  session::ProtocolMonitor monitor_;
  traffic::TrafficSnapshot snapshot_;
  std::vector<traffic::Vehicle> before_;                           ///< those of the last snapshot
  std::uint64_t before_tick_ = 0;                                  ///< its tick
  std::optional<ros::Time> first_;                                 ///< stamp of tick 0
  std::map<std::string, int> slots_;                               ///< of CBVs, by id
  std::map<std::pair<std::string, std::string>, double> touched_;  ///< when last [s]
  std::vector<traffic::Fault> pending_faults_;
  std::uint64_t next_decision_ = 0;  ///< tick
  std::uint64_t lost_ = 0;
};

}  // namespace cdiff::node_graph
