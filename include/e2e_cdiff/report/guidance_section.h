// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// What guidance did, as HTML: a chart of each active objective's value, and a table.
#pragma once

#include <string>

#include "e2e_cdiff/report/session_result.h"

namespace cdiff::report {

std::string guidanceSection(const SessionResult& result);

}  // namespace cdiff::report
