// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Tables of the HTML report, each as one HTML section.
#pragma once

#include <string>

#include "e2e_cdiff/report/session_result.h"

namespace cdiff::report {

std::string ruleTable(const SessionResult& result);
std::string metricTable(const metrics::SessionMeasures& measures);
/// The ego's infractions and penalty by the protocol.
std::string infractionTable(const metrics::SessionMeasures& measures);
std::string selectionTable(const SessionResult& result);
/// Distances between plans and what was driven, by CBV.
std::string planTable(const PlanLog& plans);
std::string guidanceTable(const GuidanceLog& log);
std::string rejectionTable(const CbvLog& cbv);
/// Of all vehicles; those of the ego with who is at fault and why.
std::string contactTable(const SessionResult& result);
std::string lateTable(const std::map<std::string, LateFigures>& late);
std::string latencyTable(const std::map<std::string, LatencyFigures>& latencies);
std::string faultTable(const std::vector<traffic::Fault>& faults);
std::string originTable(const SessionResult& result);

}  // namespace cdiff::report
