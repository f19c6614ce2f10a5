// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/markup.h"
#include "evaluation/statistics.h"

namespace cdiff::evaluation {

// What the systems of a batch did over all routes: each figure with its 95 % interval, counts with
// their km (docs/statistics.md).

/// A list with an object per system: factors, runs, routes, seeds and all measures.
nlohmann::ordered_json systemsJson(const std::vector<System>& systems);

/// A warning for each small number of seeds and routes that a system has; one without a complete
/// run has none.
std::vector<std::string> fewWarnings(const std::vector<System>& systems);

/// The main measures: warnings, a table with a row per system, and a line on multiplicity.
std::string systemsMarkdown(const std::vector<System>& systems);

/// The same for the page, without the warnings, which stand in its head.
core::Markup systemsHtml(const std::vector<System>& systems);

}  // namespace cdiff::evaluation
