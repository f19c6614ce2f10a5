// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "e2e_cdiff/guidance/guidance_options.h"
#include "e2e_cdiff/planning/planner_descriptor.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"

namespace cdiff::planning {

/// A plan that a CBV may drive (map frame, SI units).
struct ChallengePlan {
  std::vector<traffic::VehicleState> states;  ///< 0.1 s apart, the first one that far ahead
  double score = 0.0;                         ///< of plans that do not hit; the lower the better
  bool only_to_hit = false;                   ///< it is of no use unless it hits
  bool kept = false;    ///< the plan of the last decision, with a braking tail
  bool brakes = false;  ///< it withdraws: it brakes from now on
};

/// Chooses among the plans of CBVs in mode `challenging`: as dangerous as a careful driver in the
/// ego's place can still answer (docs/challenging.md). One for all CBVs of a planner.
///
/// C, the careful and competent driver of UN R157 (src/reference_driver), *answers* a plan if it
/// keeps 0.3 m from the CBV, and from the CBVs that were chosen for before, until it can stand and
/// one second more: whether the CBV then keeps its speed along its lane, brakes with 8 m/s^2, or
/// keeps its heading. A plan *hits* if an ego that keeps its speed along its route touches it with
/// the CBV moving and not behind its rear axle. Chosen is, of the plans that hit and are answered,
/// the one that C answers with the least extra delay of at least delta_min (easy 0.6 s, medium
/// 0.3 s, hard 0.1 s); else, of those that are answered, the one that hits soonest after its end
/// and within 8 s, with the CBV on its lane; else the one of the lowest score.
///
/// The first hit is a promise. A ghost starts where the ego is and is driven by C; until it is
/// clear, or for 4 s, every plan must leave the ghost an answer, and the ego, too, unless it is the
/// promised one (0.3 m, 1 m/s). A plan that touches an ego that stands by then, or with the CBV
/// behind it, is refused. Where none is left the CBV withdraws: it drives the plan that leaves C
/// the longest time.
class Challenge {
 public:
  /// `level`: easy, medium or hard; throws InputError for another one. References of the context
  /// must outlive it.
  Challenge(const PlanningContext& context, const std::string& level);
  ~Challenge();
  Challenge(const Challenge&) = delete;
  Challenge& operator=(const Challenge&) = delete;

  /// Starts a decision: every one, in the order of time, also those without a CBV.
  void startDecision(const traffic::TrafficSnapshot& snapshot);
  /// Chooses for one CBV of that snapshot, in slot order; there must be a plan. The report's
  /// `chosen` is an index into `plans`.
  guidance::ChallengeReport choose(const traffic::Vehicle& cbv,
                                   const std::vector<ChallengePlan>& plans);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace cdiff::planning
