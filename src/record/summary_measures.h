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

/// What summary.json says of the CBVs: their measures, selections, plans and faults.
Json cbvObject(const SessionResult& result);

}  // namespace cdiff::record
