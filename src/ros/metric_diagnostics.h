// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// A session's figures so far as keys and values of /diagnostics.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "metrics/session_measures.h"

namespace cdiff::ros {

/// The main figures, each "value unit (n = ...)" or "not defined: reason" under its label; then
/// under "not defined: REASON" the names of all figures that have no value for it.
std::vector<std::pair<std::string, std::string>> metricDiagnostics(
    const metrics::SessionMeasures& measures);

}  // namespace cdiff::ros
