// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/paper_systems.h"

#include "planners/registry.h"

namespace cdiff::evaluation {

std::string PaperSystem::planner() const {
  const std::string found = planners::plannerTitled(title);
  return found.empty() ? std::string("(") + title + " is not implemented)" : found;
}

const std::vector<PaperSystem>& paperEgoPlanners() {
  static const std::vector<PaperSystem> systems = {paper::kPdmLite, paper::kPlanT, paper::kUniAd,
                                                   paper::kVad, paper::kDiffusion};
  return systems;
}

const std::vector<PaperSystem>& paperCbvPlanners() {
  static const std::vector<PaperSystem> systems = {paper::kPpo, paper::kPluto, paper::kRift,
                                                   paper::kDiffusion};
  return systems;
}

const std::vector<PaperSystem>& paperExecutions() {
  static const std::vector<PaperSystem> systems = {paper::kTwoStage,
                                                   {paper::kDiffusion.title, "End-to-end control"}};
  return systems;
}

Factors egoLevel(const PaperSystem& system) { return {{"ego_planner", system.planner()}}; }

Factors cbvLevel(const PaperSystem& system) { return {{"cbv_planner", system.planner()}}; }

Factors guidanceLevels(const char* profile) {
  return {{"mode", "naturalistic"}, {"guidance_profile", profile}};
}

Factors naturalisticLevels() { return guidanceLevels("naturalistic"); }

Factors safetyCriticalLevels() {
  return {{"mode", "safety_critical"}, {"guidance_profile", "safety_critical"}};
}

Factors merged(Factors levels, const Factors& others) {
  levels.insert(others.begin(), others.end());
  return levels;
}

}  // namespace cdiff::evaluation
