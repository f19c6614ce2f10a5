// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// What summary.json says of the CBVs: their figures, selections, plans and faults.
#pragma once

#include "record/session_result.h"
#include "record/summary_figures.h"

namespace cdiff::record {

Json cbvObject(const SessionResult& result);

}  // namespace cdiff::record
