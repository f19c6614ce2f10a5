// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>
#include <vector>

#include "evaluation/run_plan.h"

namespace cdiff::evaluation {

// The systems that the paper compares, by their names there and here, and the levels that runs of
// them have in a batch.

/// A system of the paper, whether a planner with its title is registered or not. The paper's own is
/// there once by each method of config/methods that tables show.
struct PaperSystem {
  const char* title;   ///< as the descriptor of its planner has it
  const char* name;    ///< in the table
  const char* method;  ///< of its runs
  explicit constexpr PaperSystem(const char* a_title) : PaperSystem(a_title, a_title) {}
  constexpr PaperSystem(const char* a_title, const char* a_name, const char* a_method = "default")
      : title(a_title), name(a_name), method(a_method) {}
  /// Name of its planner here.
  std::string planner() const;
};

inline constexpr const char* kNaturalistic = "naturalistic";
inline constexpr const char* kSafetyCritical = "safety_critical";

namespace paper {
inline constexpr PaperSystem kPdmLite("PDM-Lite");
inline constexpr PaperSystem kPlanT("PlanT");
inline constexpr PaperSystem kUniAd("UniAD mini");
inline constexpr PaperSystem kVad("VAD mini");
inline constexpr PaperSystem kPpo("PPO");
inline constexpr PaperSystem kPluto("Pluto");
inline constexpr PaperSystem kRift("RIFT");
inline constexpr PaperSystem kDiffusion("E2E-CDiff", "E2E-CDiff (method default)");
inline constexpr PaperSystem kPaperMethod(
    "E2E-CDiff", "E2E-CDiff (paper's sampling, guidance and inputs, our weights)", "paper");
inline constexpr PaperSystem kTwoStage("Two-stage trajectory-then-PID");
}  // namespace paper

/// In the paper's order; its own system by method default, then by method paper.
const std::vector<PaperSystem>& paperEgoPlanners();
const std::vector<PaperSystem>& paperCbvPlanners();
/// Two-stage and end-to-end, by method default, then by method paper.
const std::vector<PaperSystem>& paperExecutions();

/// Variant of the sensitivity row of Table 4 in evaluation paper_tables: the two-stage planner
/// follows its plans as PDM-Lite steers and drives.
inline constexpr const char* kSecondTracker = "pdm_lite_tracker";

/// Level of runs that a system drives as ego.
Factors egoLevel(const PaperSystem& system);
/// Levels of runs whose CBVs a system drives: planner, method, mode and the guidance profile that
/// the method names for the mode.
Factors cbvLevels(const PaperSystem& system, const char* mode = kNaturalistic);
/// Of both; where they contradict each other, the first.
Factors merged(Factors levels, const Factors& others);

}  // namespace cdiff::evaluation
