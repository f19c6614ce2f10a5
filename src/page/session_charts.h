// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Charts of a session: speeds, distance between ego and CBVs, commands.
#pragma once

#include <string>

#include "record/session_result.h"

namespace cdiff::page {

/// All charts with their common legend, as HTML.
std::string sessionCharts(const record::SessionResult& result);

}  // namespace cdiff::page
