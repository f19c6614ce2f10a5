// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The table of a session's figures as Markdown, for docs/metrics.md and `cdiff metric
/// definitions`.
#pragma once

#include <string>

namespace cdiff::record {

/// A section a figure, in the order of summary.json: name, label, unit, subject, direction, place,
/// definition and how RIFT's code differs.
std::string figureList();

}  // namespace cdiff::record
