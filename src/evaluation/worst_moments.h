// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "evaluation/run_record.h"

namespace cdiff::evaluation {

/// A moment of a run that is worth a look: a contact of the ego, or its closest approach.
struct WorstMoment {
  std::size_t run = 0;            ///< index of the run
  std::optional<double> seconds;  ///< time in the session [s]; absent: the report opens there
  std::string text;               ///< what happened
};

/// At most `most`: contacts at the ego's fault, then others, the faster of the two vehicles first;
/// then, of runs without a contact, the closest approaches. Of equals the first run's.
std::vector<WorstMoment> worstMoments(const std::vector<BatchRun>& runs, std::size_t most = 5);

}  // namespace cdiff::evaluation
