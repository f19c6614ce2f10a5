// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/paper/paper_systems.h"

#include "planners/registry.h"
#include "session/session_request.h"

namespace cdiff::evaluation {

std::string PaperSystem::planner() const { return planners::plannerTitled(title); }

const std::vector<PaperSystem>& paperEgoPlanners() {
  static const std::vector<PaperSystem> systems = {paper::kPdmLite,   paper::kPlanT,
                                                   paper::kUniAd,     paper::kVad,
                                                   paper::kDiffusion, paper::kPaperMethod};
  return systems;
}

const std::vector<PaperSystem>& paperCbvPlanners() {
  static const std::vector<PaperSystem> systems = {paper::kPpo, paper::kPluto, paper::kRift,
                                                   paper::kDiffusion, paper::kPaperMethod};
  return systems;
}

const std::vector<PaperSystem>& paperExecutions() {
  static const std::vector<PaperSystem> systems = {
      {paper::kTwoStage.title, "Two-stage trajectory-then-PID (method default)"},
      {paper::kDiffusion.title, "End-to-end control (method default)"},
      {paper::kTwoStage.title, "Two-stage trajectory-then-PID (method paper)", "paper"},
      {paper::kDiffusion.title, "End-to-end control (method paper)", "paper"}};
  return systems;
}

Factors egoLevel(const PaperSystem& system) { return {{"ego_planner", system.planner()}}; }

Factors cbvLevels(const PaperSystem& system, const char* mode) {
  return {{"cbv_planner", system.planner()},
          {"method", system.method},
          {"mode", mode},
          {"guidance_profile", session::loadMethod(system.method).profileOf(mode)}};
}

Factors merged(Factors levels, const Factors& others) {
  levels.insert(others.begin(), others.end());
  return levels;
}

}  // namespace cdiff::evaluation
