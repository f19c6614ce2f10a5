// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/paper/paper_figures.h"

#include <algorithm>
#include <set>

#include "core/file.h"
#include "evaluation/paper/paper_definitions.h"
#include "evaluation/paper/paper_table.h"
#include "planners/registry.h"

namespace cdiff::evaluation {
namespace {

/// The paper's own system without and with collision-seeking guidance by both methods, ego
/// PDM-Lite.
std::vector<ShownSystem> shownModes() {
  std::vector<ShownSystem> systems;
  for (const PaperSystem& own : {paper::kDiffusion, paper::kPaperMethod}) {
    for (const char* mode : {kNaturalistic, kSafetyCritical}) {
      systems.push_back({std::string("E2E-CDiff") + (mode == kSafetyCritical ? " w/ coll" : "") +
                             " (method " + own.method + ")",
                         merged(egoLevel(paper::kPdmLite), cbvLevels(own, mode))});
    }
  }
  return systems;
}

}  // namespace

std::vector<ShownSystem> shownCbvPlanners(const std::vector<BatchRun>& runs) {
  std::vector<ShownSystem> systems;
  std::set<std::string> further;
  Factors levels = cbvLevels(paper::kPdmLite);
  levels["ego_planner"] = paper::kPdmLite.planner();
  levels.erase("cbv_planner");
  for (const BatchRun* run : runsWith(runs, levels))
    further.insert(run->record.factors.at("cbv_planner"));
  for (const PaperSystem& system : paperCbvPlanners()) {
    systems.push_back({system.name, merged(egoLevel(paper::kPdmLite), cbvLevels(system))});
    further.erase(system.planner());
  }
  for (const std::string& planner : further) {
    systems.push_back({planner + " (not in the paper)", levels});
    systems.back().levels["cbv_planner"] = planner;
  }
  return systems;
}

std::string reasonOf(const ShownSystem& system, const std::vector<BatchRun>& runs,
                     const std::string& otherwise) {
  const std::vector<std::string> known = planners::plannerNames();
  const std::string& planner = system.levels.at("cbv_planner");
  if (std::find(known.begin(), known.end(), planner) == known.end()) return "not implemented";
  if (runsWith(runs, system.levels).empty()) return "not run";
  return completeRuns(runs, system.levels).empty() ? "no run completed" : otherwise;
}

std::vector<const BatchRun*> completeRuns(const std::vector<BatchRun>& runs,
                                          const Factors& levels) {
  std::vector<const BatchRun*> found = runsWith(runs, levels);
  found.erase(std::remove_if(found.begin(), found.end(),
                             [](const BatchRun* run) { return !run->record.complete(); }),
              found.end());
  return found;
}

std::size_t countSeeds(const std::vector<const BatchRun*>& runs) {
  std::set<std::string> seeds;
  for (const BatchRun* run : runs) seeds.insert(run->record.factors.at("seed"));
  return seeds.size();
}

std::vector<Figure> paperFigures(const std::vector<BatchRun>& runs) {
  Figure latency = barFigure(latencyFigure(), runs);
  latency.wall_clock = true;
  return {
      distributionFigure(runs),
      barFigure(collisionFigure(), runs),
      frameFigure("figure_5", "Figure 5. CBV planners from above", shownCbvPlanners(runs), runs),
      frameFigure("figure_6", "Figure 6. Safety-critical scenario generation from above",
                  shownModes(), runs),
      executionFigure(runs),
      latency};
}

}  // namespace cdiff::evaluation
