// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/system_names.h"

#include <algorithm>
#include <set>

#include "core/text.h"
#include "evaluation/run_plan.h"

namespace cdiff::evaluation {
namespace {

/// SystemLevels of some factors of a system, in their order.
using SystemLevels = std::vector<std::string>;

SystemLevels systemLevels(const System& system, const std::vector<std::string>& factors) {
  SystemLevels levels;
  for (const std::string& factor : factors) levels.push_back(system.factors.at(factor));
  return levels;
}

std::size_t countKinds(const std::vector<System>& systems,
                       const std::vector<std::string>& factors) {
  std::set<SystemLevels> kinds;
  for (const System& system : systems) kinds.insert(systemLevels(system, factors));
  return kinds.size();
}

/// The fewest factors in the order of factorNames(), each of which distinguishes systems that those
/// before it do not.
std::vector<std::string> distinguishing(const std::vector<System>& systems) {
  std::vector<std::string> chosen;
  for (const std::string& factor : factorNames()) {
    if (systems.front().factors.count(factor) == 0) continue;
    std::vector<std::string> more = chosen;
    more.push_back(factor);
    if (countKinds(systems, more) > countKinds(systems, chosen)) chosen = more;
  }
  return chosen;
}

std::string modeText(const std::string& mode) {
  if (mode == "safety_critical") return "in attack";
  return mode == "naturalistic" ? "driving naturally" : mode;
}

/// What a level adds behind the planner of the CBVs.
std::string levelWords(const std::string& factor, const std::string& level) {
  if (factor == "mode") return modeText(level);
  if (level.empty()) return "";
  const std::string name = levelName(factor, level);
  if (factor == "method") return "by method " + name;
  if (factor == "guidance_profile") return name == "none" ? "unguided" : "guided by " + name;
  return factor + " " + name;
}

/// The parts that are not empty, joinedWords by blanks.
std::string joinedWords(std::vector<std::string> parts) {
  parts.erase(std::remove(parts.begin(), parts.end(), ""), parts.end());
  return core::joinText(parts, " ");
}

std::string nameForPeople(const System& system, const std::vector<std::string>& factors) {
  const bool ego = std::count(factors.begin(), factors.end(), "ego_planner") != 0;
  const bool ego_alone = ego && factors.size() == 1;
  std::vector<std::string> cbv;
  if (!ego_alone) cbv.push_back(system.factors.at("cbv_planner"));
  for (const std::string& factor : factors) {
    if (factor != "ego_planner" && factor != "cbv_planner")
      cbv.push_back(levelWords(factor, system.factors.at(factor)));
  }
  if (!ego) return joinedWords(cbv);
  const std::string name = "ego " + system.factors.at("ego_planner");
  return ego_alone ? name : name + ", CBVs " + joinedWords(cbv);
}

}  // namespace

SystemNames::SystemNames(const std::vector<System>& systems) {
  if (systems.empty()) return;
  const std::vector<std::string> factors = distinguishing(systems);
  egos_differ_ = std::count(factors.begin(), factors.end(), "ego_planner") != 0;
  for (const System& system : systems) names_[system.factors] = nameForPeople(system, factors);
}

const std::string& SystemNames::of(const Factors& factors) const {
  return names_.at(systemFactors(factors));
}

Factors systemFactors(Factors factors) {
  for (const char* pooled : {"scenario", "seed", "repetition"}) factors.erase(pooled);
  return factors;
}

}  // namespace cdiff::evaluation
