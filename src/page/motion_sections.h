// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>

#include "record/session_result.h"

namespace cdiff::page {

/// Distributions of speed and acceleration of CBVs against background vehicles, as HTML.
std::string drivingSection(const record::SessionResult& result);

/// What guidance did, as HTML: a chart of each active objective's value, and a table.
std::string guidanceSection(const record::SessionResult& result);

}  // namespace cdiff::page
