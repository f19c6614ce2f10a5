// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <optional>
#include <string>

#include "evaluation/intervals/pooled_estimate.h"

namespace cdiff::evaluation {

// Estimates as text for people, in Markdown and HTML alike.

/// Fewer seeds than these are warned of.
inline constexpr std::size_t kLeastSeeds = 5;

/// "20.123 [18.4, 22.0]", of counts "7 / 1.520 km = 4.605 [1.851, 9.488]"; "-" without a value.
std::string estimateText(const PooledEstimate& estimate, int decimals = 3);

/// " [18.400, 22.000]", or nothing.
std::string intervalText(const std::optional<Interval>& interval, int decimals = 3);

/// "0.012", "< 0.001".
std::string probabilityText(double p);

/// What a reader has to know of it: over-dispersed, no distances, routes all alike; or nothing.
std::string estimateNote(const PooledEstimate& estimate);

/// "1 route", "10 routes".
std::string countText(std::size_t count, const std::string& noun);

/// A sentence where there are fewer than kLeastSeeds seeds, or so few clusters (routes, or what
/// else was drawn) that intervals say little; else nothing.
std::string fewWarning(std::size_t seeds, std::size_t clusters, bool routes);

}  // namespace cdiff::evaluation
