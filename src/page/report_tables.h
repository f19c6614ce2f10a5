// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Tables of the HTML report, each as one HTML section.
#pragma once

#include <string>

#include "record/session_result.h"

namespace cdiff::page {

std::string ruleTable(const record::SessionResult& result);
std::string metricTable(const metrics::SessionMeasures& measures);
/// The ego's infractions and penalty by the protocol.
std::string infractionTable(const metrics::SessionMeasures& measures);
std::string selectionTable(const record::SessionResult& result);
/// Distances between plans and what was driven, by CBV.
std::string planTable(const record::PlanLog& plans);
std::string guidanceTable(const record::GuidanceLog& log);
std::string rejectionTable(const record::CbvLog& cbv);
/// Of all vehicles; those of the ego with who is at fault and why.
std::string contactTable(const record::SessionResult& result);
std::string lateTable(const std::map<std::string, record::LateFigures>& late);
std::string latencyTable(const std::map<std::string, record::LatencyFigures>& latencies);
std::string faultTable(const std::vector<traffic::Fault>& faults);
std::string originTable(const record::SessionResult& result);

}  // namespace cdiff::page
