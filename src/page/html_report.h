// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>

#include "record/session_result.h"

namespace cdiff::page {

/// Text of report.html: one self-contained page with verdict, main measures, a picture from above,
/// charts and tables.
std::string htmlReport(const record::SessionResult& result);

}  // namespace cdiff::page
