// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "metrics/session_metrics.h"
#include "record/session_result.h"

namespace cdiff::record {

// Measures of a session as they stand in summary.json: null where absent, with the reason beside.

using Json = nlohmann::ordered_json;

/// The value, or null.
Json number(const std::optional<double>& value);

/// `key: value`, and `key_reason` beside it where there is one.
void addMeasure(Json& object, const std::string& key, const metrics::Measure& measure);

/// The same with a whole number for a count.
void addPlainMeasure(Json& object, const std::string& key, const metrics::Measure& measure);

/// Adds the measures, then the lists, whose place in the summary starts with "/section/".
void addMeasures(Json& object, const std::string& section,
                 const metrics::SessionMeasures& measures);

/// What summary.json says about the CBVs: their measures, selections, plans and faults.
Json cbvObject(const SessionResult& result);

// Text of summary.json: the session's measures under fixed keys in a fixed order; an absent measure
// is null beside a reason.

std::string summaryJson(const SessionResult& result);

/// Id of the vehicle that a CBV touched last during its stay; nullopt when none.
std::optional<std::string> contactPartner(const CbvRecord& record, const SessionResult& result);

/// Whether a selected conflict lies at or beyond the first junction of the ego route.
bool atOrBeyondFirstJunction(const cbv::ConflictPoint& conflict, const map::Route& ego_route);

}  // namespace cdiff::record
