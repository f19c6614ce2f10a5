// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <string>
#include <vector>

#include "session/session_setup.h"
#include "session/steered_cbvs.h"
#include "session/steering.h"

namespace cdiff::session {

/// The one way into a running session: its pace (play, pause, step, at most k times real time) and
/// what is steered in it. A request is checked at once; what it changes is in force at the next
/// decision, whose snapshot carries it to all who need it and acknowledges it. Pace changes nothing
/// of what a session computes and is not recorded.
/// Requests may come from any thread; the world and the loop that drives it are one thread.
class SessionControl {
 public:
  using Clock = std::chrono::steady_clock;
  enum class State { kPlaying, kPaused, kStepping, kOver };

  /// With the requests of the scenario. Throws InputError for one that names a lane that the
  /// network does not have. `setup` must outlive the object.
  explicit SessionControl(const SessionSetup& setup);

  // For who steers. All throw InputError, and change nothing, for what cannot be now.

  State state() const;
  /// Before the next tick. Not when paused, nor where the wall clock rules (real_time_factor).
  void pause();
  void resume();
  /// Returns at once: so many ticks follow, then the session is paused again. Only when paused.
  void step(std::uint64_t ticks);
  /// Waits until no tick of `step` is left, at most `seconds` of wall time; false when one is.
  bool awaitSteps(double seconds);
  /// At most so many times real time; 0: as fast as possible.
  void setPace(double at_most);
  double pace() const;
  /// In force at the next decision. Only what can be at present: a profile, mode or objective that
  /// exists, a value in its range, a vehicle that is there in a role that fits.
  void ask(const SteeringRequest& request);
  /// What was asked for last of a subject of SteeredCbvs, or its present value.
  std::string value(const std::string& what) const;
  /// Ends the session as interrupted before the next tick.
  void quit();
  bool quitting() const;

  // For the world and its loop.

  /// How long to wait before the next tick, after which the question comes again; zero: it may
  /// begin, and counts as a step. `simulated`: time of the tick that stands [s].
  Clock::duration holdBack(double simulated, Clock::time_point now);
  /// What changes at a decision at `simulated` [s], with these vehicles there; who asks for what
  /// can no longer be gets a line in `refused`.
  std::vector<traffic::SteeringChange> take(double simulated, const VehicleRoles& vehicles,
                                            std::vector<std::string>& refused);
  /// The vehicles of the decision that follows `take`.
  void note(VehicleRoles vehicles);
  /// The session has ended.
  void end();

 private:
  struct Scheduled {
    double at = 0.0;  ///< [s]
    SteeringRequest request;
  };
  void requirePace(const std::string& what) const;
  void requireVehicle(const SteeringRequest& request, const VehicleRoles& vehicles) const;
  void requirePlace(const PlacedVehicle& vehicle, const VehicleRoles& vehicles) const;
  void requireLane(const PlacedVehicle& vehicle) const;
  traffic::SteeringChange changeBy(const SteeringRequest& request,
                                   const VehicleRoles& vehicles) const;

  const SessionSetup& setup_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  State state_ = State::kPlaying;
  std::uint64_t steps_ = 0;  ///< left
  double at_most_;
  double paced_from_ = 0.0;        ///< simulated time that the pace counts from [s]
  Clock::time_point paced_since_;  ///< the wall clock then
  bool pace_begins_ = true;        ///< at the next tick
  bool quitting_ = false;
  std::vector<Scheduled> scheduled_;  ///< by time
  std::vector<SteeringRequest> asked_;
  VehicleRoles vehicles_;
  SteeredCbvs cbvs_;
};

}  // namespace cdiff::session
