// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "record/logs/wait_chain.h"
#include "session/session_setup.h"

namespace cdiff::record {

/// An ego that stands and then moves slower than this goes on standing [m/s].
inline constexpr double kCreepSpeed = 1.0;

/// What held the ego up in a session that ended blocked or timed out, from traffic data alone.
/// Times are simulated [s].
struct HoldUp {
  double begin = 0.0;       ///< of the standstill; of a session without one: 0
  double seconds = 0.0;     ///< how long the ego stood there, slower than kCreepSpeed at any time
  double crept = 0.0;       ///< part of this in which it crept: faster than protocol.blocked_speed
  double stood = 0.0;       ///< how long it stood or crept in the whole session
  double slow = 0.0;        ///< how long it drove slower than half its target speed
  std::string held_behind;  ///< the vehicle that was before it for most of both; may be empty
  double held_behind_seconds = 0.0;
  bool at_end = false;                  ///< the ego still stood when the session ended
  WaitChain chain;                      ///< at the end of the standstill; empty without one
  std::optional<double> traffic_still;  ///< how long nothing within 50 m of the ego had moved;
                                        ///< absent where no vehicle was there
  std::vector<std::string> cbvs;        ///< vehicles of the chain that are or were CBVs
};

/// Watches what the ego waits for, each second and at the end. Independent of who drives the ego
/// and of the deployment.
class HoldUpLog {
 public:
  /// `setup` must outlive the log.
  explicit HoldUpLog(const session::SessionSetup& setup);

  /// Every tick in order.
  void observe(const traffic::TrafficSnapshot& snapshot);
  /// Of a session that ended blocked or timed out; nullopt for every other status.
  const std::optional<HoldUp>& found() const { return found_; }

 private:
  void noteStandstill(const traffic::TrafficSnapshot& snapshot, double speed);
  void noteMotion(const traffic::TrafficSnapshot& snapshot, const traffic::Vehicle& ego);
  void noteSlowness(const traffic::Vehicle& ego, bool stands, const WaitChain& chain);
  HoldUp standstill(const traffic::TrafficSnapshot& snapshot, const WaitChain& chain) const;
  void conclude(const traffic::TrafficSnapshot& snapshot, const WaitChain& chain);

  WaitChain chainAt(const traffic::TrafficSnapshot& snapshot) const;

  const session::SessionSetup& setup_;
  std::optional<session::DemandFile> demand_;  ///< absent where none is given or it is gone
  std::optional<double> standing_since_;       ///< or creeping
  double crept_ = 0.0;                         ///< of this standstill
  std::optional<double> traffic_still_since_;
  bool company_ = false;  ///< a vehicle was near the ego at the last tick
  double stood_ = 0.0;
  double slow_ = 0.0;
  std::map<std::string, double> held_behind_;
  std::set<std::string> cbvs_;
  std::optional<HoldUp> longest_;
  std::optional<HoldUp> found_;
};

/// One sentence or two for people: who or what stood in the ego's way, the head of the queue and
/// what it waits for, how long the traffic has stood, whether a CBV has a part in it.
std::string holdUpText(const HoldUp& hold_up, const session::SessionSetup& setup,
                       traffic::SessionStatus status);

}  // namespace cdiff::record
