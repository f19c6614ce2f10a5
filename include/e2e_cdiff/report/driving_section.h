// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Distributions of speed and acceleration of CBVs against background vehicles, as HTML.
#pragma once

#include <string>

#include "e2e_cdiff/report/session_result.h"

namespace cdiff::report {

std::string drivingSection(const SessionResult& result);

}  // namespace cdiff::report
