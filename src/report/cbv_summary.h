// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// What summary.json says of the CBVs: their figures, selections, plans and faults.
#pragma once

#include "e2e_cdiff/report/session_result.h"
#include "summary_figures.h"

namespace cdiff::report {

Json cbvObject(const SessionResult& result);

}  // namespace cdiff::report
