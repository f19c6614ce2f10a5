// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "realism/likelihood.h"
#include "session/session_setup.h"
#include "session/target_speed.h"

namespace cdiff::realism {

/// Who drives the vehicles of the first hand-over from there on.
struct HandOverDriver {
  std::string planner;             ///< of the table of planners; empty: SUMO, as if nothing was
                                   ///< handed over
  std::uint64_t planner_seed = 1;  ///< root seed of the planner's draws, instead of the session's
  /// v* of each vehicle: the scenario's target_speed, or a draw of `planner_seed`.
  session::CbvSpeedOptions target_speed = {};
};

/// What became of the vehicles of a session's first hand-over.
struct Continuation {
  std::uint64_t hand_over_tick = 0;
  std::string sha256;                ///< of all vehicles at all ticks up to the hand-over
  std::vector<std::string> objects;  ///< CBVs of the first hand-over, by slot
  /// By object: all features at every 0.1 s after the hand-over, all of `seconds`; NaN from where
  /// the vehicle left the simulation or the planner, or the session ended. The features are those
  /// of the challenge: central differences, and signed distances of boxes. Indicators look at every
  /// tick since the last step.
  std::vector<Course> courses;
};

/// Runs the session of the setup up to its first hand-over and `seconds` on. Until then no CBV
/// planner is asked, so that the same setup gives the same bytes whoever the driver is; from then
/// on the vehicles of that hand-over are driven by `driver`, as long as the life cycle of CBVs
/// leaves them in their slots, and no other is taken over. nullopt for a session without a
/// hand-over. Throws InputError for an unknown planner and a decision period other than 0.1 s,
/// SimulatorError when the session ends by an error.
std::optional<Continuation> continueSession(const session::SessionSetup& setup,
                                            const HandOverDriver& driver, double seconds);

/// A scenario against its log.
struct ContinuationOptions {
  std::int64_t rollouts = 32;
  double seconds = 8.0;  ///< after the hand-over
};

/// The scores of one driver in one session.
struct ContinuationScore {
  std::optional<std::uint64_t> hand_over_tick;  ///< absent without a hand-over
  std::vector<std::string> objects;
  LikelihoodSums sums;
  std::size_t log_steps = 0;      ///< of all objects in the log
  std::size_t rollout_steps = 0;  ///< of all objects in all rollouts
};

/// Rollouts of a driver (a planner, or SUMO where it is empty) against the log of the same
/// hand-over: PDM-Lite with a driver that no rollout has. Seeds are draws of the session's stream
/// "realism": 0 is the log's, 1 to n are those of the rollouts, the same for every planner. Where
/// the scenario draws cbv_target_speed, each rollout draws anew; the log's driver keeps to
/// target_speed (and its own spread), so that every row has the same log. SUMO
/// has no seed of its own after the hand-over: its one course counts as all rollouts. Throws
/// InputError where PDM-Lite's drivers do not differ (pdm_lite.cbv_speed_spread,
/// pdm_lite.cbv_headway_spread), std::logic_error when two courses differ before the hand-over.
ContinuationScore scoreDriver(const session::SessionSetup& setup, const std::string& planner,
                              const ContinuationOptions& options);

}  // namespace cdiff::realism
