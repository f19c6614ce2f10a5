// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Distributions of speed and acceleration of CBVs against background vehicles, as HTML.
#pragma once

#include <string>

#include "record/session_result.h"

namespace cdiff::page {

std::string drivingSection(const record::SessionResult& result);

}  // namespace cdiff::page
