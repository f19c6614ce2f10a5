// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>

#include "record/session_result.h"

namespace cdiff::record {

// Text of summary.json: the session's measures under fixed keys in a fixed order; an absent measure
// is null beside a reason.

std::string summaryJson(const SessionResult& result);

/// Id of the vehicle that a CBV touched last during its stay; nullopt when none.
std::optional<std::string> contactPartner(const CbvRecord& record, const SessionResult& result);

/// Whether a selected conflict lies at or beyond the first junction of the ego route.
bool atOrBeyondFirstJunction(const cbv::ConflictPoint& conflict, const map::Route& ego_route);

}  // namespace cdiff::record
