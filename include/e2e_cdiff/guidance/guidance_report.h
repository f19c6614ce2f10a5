// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace cdiff::guidance {

/// One objective over the denoising steps of the sample that was chosen.
struct ObjectiveReport {
  std::string name;
  double weight = 0.0;
  double value = 0.0;          ///< J of the rollout that was chosen (unweighted)
  double gradient_norm = 0.0;  ///< mean over active steps of |w dJ/d tau| where the step starts,
                               ///< before the cap, normalized units
  double capped_share = 0.0;   ///< share of active steps in which the gradient cap acted, [0, 1]
  std::int64_t dropped = 0;    ///< steps in which it was not finite and left out
};

/// What guidance did in one decision of one vehicle, for people and records.
struct GuidanceReport {
  std::vector<ObjectiveReport> objectives;  ///< active ones, in the table's order
  std::int64_t candidates = 0;              ///< samples drawn
  std::int64_t chosen = 0;                  ///< index of the one that drives
  double trust_region_share = 0.0;  ///< share of guided steps in which the trust region acted
};

}  // namespace cdiff::guidance
