// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <map>
#include <string>
#include <vector>

#include "evaluation/statistics.h"

namespace cdiff::evaluation {

/// Names for people of a batch's systems: "diffusion in attack", "ego plant, CBVs pdm_lite driving
/// naturally". Of the factors a name holds the planner of the CBVs and what else is needed to
/// distinguish the systems; a factor that follows the others is left out.
class SystemNames {
 public:
  explicit SystemNames(const std::vector<System>& systems);

  /// Of a system or a run, by its factors; those that a system does not have are passed over.
  const std::string& of(const Factors& factors) const;
  /// Whether the systems differ in more than what drives CBVs.
  bool egosDiffer() const { return egos_differ_; }

 private:
  std::map<Factors, std::string> names_;
  bool egos_differ_ = false;
};

/// The factors of a run without scenario, seed and repetition.
Factors systemFactors(Factors factors);

}  // namespace cdiff::evaluation
