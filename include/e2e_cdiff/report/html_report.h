// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Text of report.html: one self-contained page with verdict, figures, a picture from above, charts
/// and tables.
#pragma once

#include <string>

#include "e2e_cdiff/report/session_result.h"

namespace cdiff::report {

std::string htmlReport(const SessionResult& result);

}  // namespace cdiff::report
