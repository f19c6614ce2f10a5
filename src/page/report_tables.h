// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/markup.h"
#include "record/session_result.h"

namespace cdiff::page {

// Tables of the HTML report.

core::Markup ruleTable(const record::SessionResult& result);
/// All measures in groups, each with its definition folded in.
core::Markup metricTables(const metrics::SessionMeasures& measures);
/// The ego's infractions and penalty by the protocol.
core::Markup infractionTable(const metrics::SessionMeasures& measures);
core::Markup selectionTable(const record::SessionResult& result);
/// Distances between plans and what was driven, by CBV.
core::Markup planTable(const record::PlanLog& plans);
core::Markup guidanceTable(const record::GuidanceLog& log);
/// What mode challenging came to: attacks, withdrawals and refused plans by reason.
core::Markup challengeTable(const record::ChallengeCounts& counts);
core::Markup rejectionTable(const record::CbvLog& cbv);
/// Of all vehicles; those of the ego with who is at fault and why.
core::Markup contactTable(const record::SessionResult& result);
core::Markup lateTable(const std::map<std::string, record::LateCounts>& late);
core::Markup latencyTable(const std::map<std::string, record::LatencySummary>& latencies);
core::Markup steeringTable(const record::SessionResult& result);
core::Markup faultTable(const std::vector<traffic::Fault>& faults);
core::Markup originTable(const record::SessionResult& result);

}  // namespace cdiff::page
