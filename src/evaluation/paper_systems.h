// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The systems that the paper compares, by their names there and here, and the levels that runs of
/// them have in a batch.
#pragma once

#include <string>
#include <vector>

#include "evaluation/run_plan.h"

namespace cdiff::evaluation {

/// A system of the paper, whether a planner with its title is registered or not.
struct PaperSystem {
  const char* title;  ///< as the descriptor of its planner has it
  const char* name;   ///< in the table
  explicit constexpr PaperSystem(const char* a_title) : PaperSystem(a_title, a_title) {}
  constexpr PaperSystem(const char* a_title, const char* a_name) : title(a_title), name(a_name) {}
  /// Name of its planner here; where there is none, a level that no run has.
  std::string planner() const;
};

namespace paper {
inline constexpr PaperSystem kPdmLite("PDM-Lite");
inline constexpr PaperSystem kPlanT("PlanT");
inline constexpr PaperSystem kUniAd("UniAD");
inline constexpr PaperSystem kVad("VAD");
inline constexpr PaperSystem kPpo("PPO");
inline constexpr PaperSystem kPluto("Pluto");
inline constexpr PaperSystem kRift("RIFT");
inline constexpr PaperSystem kDiffusion("E2E-CDiff");
inline constexpr PaperSystem kTwoStage("Two-stage trajectory-then-PID");
}  // namespace paper

/// In the paper's order.
const std::vector<PaperSystem>& paperEgoPlanners();
const std::vector<PaperSystem>& paperCbvPlanners();
/// Two-stage and end-to-end.
const std::vector<PaperSystem>& paperExecutions();

/// Levels of runs that a system drives as ego, as CBVs.
Factors egoLevel(const PaperSystem& system);
Factors cbvLevel(const PaperSystem& system);
/// Levels of naturalistic runs with a guidance profile.
Factors guidanceLevels(const char* profile);
/// Levels of runs without and with collision-seeking guidance.
Factors naturalisticLevels();
Factors safetyCriticalLevels();
/// Both; where they contradict each other, the first.
Factors merged(Factors levels, const Factors& others);

}  // namespace cdiff::evaluation
