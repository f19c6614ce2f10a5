// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The systems that the paper compares, by their names there and here, and the levels that runs of
/// them have in a batch.
#pragma once

#include <vector>

#include "evaluation/run_plan.h"

namespace cdiff::evaluation {

/// A system of the paper and the planner that it is here, whether it exists yet or not.
struct PaperSystem {
  const char* name;     ///< "E2E-CDiff"
  const char* planner;  ///< "diffusion"
};

/// The planner name table: a planner of another name here is one change in its line.
namespace paper {
inline constexpr PaperSystem kPdmLite = {"PDM-Lite", "pdm_lite"};
inline constexpr PaperSystem kPlanT = {"PlanT", "plant"};
inline constexpr PaperSystem kUniAd = {"UniAD", "uniad"};
inline constexpr PaperSystem kVad = {"VAD", "vad"};
inline constexpr PaperSystem kPpo = {"PPO", "ppo"};
inline constexpr PaperSystem kPluto = {"Pluto", "pluto"};
inline constexpr PaperSystem kRift = {"RIFT", "rift"};
inline constexpr PaperSystem kDiffusion = {"E2E-CDiff", "diffusion"};
inline constexpr PaperSystem kTwoStage = {"Two-stage trajectory-then-PID", "two_stage_pid"};
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
