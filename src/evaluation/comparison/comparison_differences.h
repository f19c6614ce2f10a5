// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <set>
#include <string>
#include <vector>

#include "evaluation/run_conditions.h"
#include "evaluation/run_record.h"

namespace cdiff::evaluation {

/// A factor, or a key of the scenario, that is not the same in A and in B.
struct Difference {
  std::string name;
  std::set<std::string> a;  ///< its values in the runs of the pairs
  std::set<std::string> b;
  std::size_t pairs = 0;  ///< in which they differ
};

/// What other than chance can cause a difference between the runs of the pairs.
struct Differences {
  std::vector<Difference> factors;   ///< in the order of factorNames
  std::vector<Difference> settings;  ///< by key
  std::set<std::string> files;       ///< names of inputs with another content
  bool known = true;                 ///< false where the runs' scenarios were not read
};

/// Runs of A and of B that agree in all factors by which they are paired, in order.
struct RunPair {
  std::vector<const RunRecord*> a;
  std::vector<const RunRecord*> b;
};

/// Of the first runs of each pair. Settings are left out where scenarios do not pair.
Differences differencesOf(const std::vector<RunPair>& pairs, const BatchConditions& a,
                          const BatchConditions& b);

/// "cbv_planner (A pdm_lite, B diffusion); key diffusion.conditioning (A image, B image_route);
/// file program": plain text without an end, or that nothing on record differs.
std::string differencesText(const Differences& differences, std::size_t pairs);

}  // namespace cdiff::evaluation
