// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstddef>
#include <vector>

#include "evaluation/run_plan.h"

namespace cdiff::evaluation {

/// Indices of all runs in the order in which a batch runs them: systems take turns, each goes
/// through all scenarios before it comes to one again, and what is left open is drawn by a hash of
/// the ids. The runs that end first are thus a fair sample of all, from which the time that is left
/// can be told.
std::vector<std::size_t> runOrder(const std::vector<PlannedRun>& runs);

}  // namespace cdiff::evaluation
