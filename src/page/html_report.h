// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/markup.h"
#include "page/pictures/top_view.h"
#include "record/session_result.h"

namespace cdiff::page {

/// Text of report.html: one self-contained page with verdict, main measures, a picture from above,
/// charts and tables.
std::string htmlReport(const record::SessionResult& result);

// Tables of the HTML report.

core::Markup ruleTable(const record::SessionResult& result);
core::Markup metricTable(const metrics::SessionMeasures& measures);
/// The ego's infractions and penalty by the protocol.
core::Markup infractionTable(const metrics::SessionMeasures& measures);
core::Markup selectionTable(const record::SessionResult& result);
/// Distances between plans and what was driven, by CBV.
core::Markup planTable(const record::PlanLog& plans);
core::Markup guidanceTable(const record::GuidanceLog& log);
core::Markup rejectionTable(const record::CbvLog& cbv);
/// Of all vehicles; those of the ego with who is at fault and why.
core::Markup contactTable(const record::SessionResult& result);
core::Markup lateTable(const std::map<std::string, record::LateCounts>& late);
core::Markup latencyTable(const std::map<std::string, record::LatencySummary>& latencies);
core::Markup faultTable(const std::vector<traffic::Fault>& faults);
core::Markup originTable(const record::SessionResult& result);

// One plan of a CBV against what it drove over the plan's horizon: from above (map frame), and
// speed over the time since the decision.

/// Pictures and legend, for a plan whose whole horizon was driven.
core::Markup planPictures(const record::SessionResult& result, const record::VehiclePlans& vehicle,
                          const record::LoggedPlan& plan);

// The CBVs that came nearest to the ego: what CBV and ego saw at the closest approach, and a plan
// from 3 s before against what was driven.

/// At most this many CBVs are shown with pictures.
inline constexpr std::size_t kMostApproaches = 4;

/// The approaches that are shown, smallest gap first (ties: the vehicle that was driven first).
std::vector<const record::Approach*> shownApproaches(const record::ApproachLog& log);

/// Renders the front views again, at 640 x 384 pixels.
core::Markup approachSection(const record::SessionResult& result);

/// Distributions of speed and acceleration of CBVs against background vehicles.
core::Markup drivingSection(const record::SessionResult& result);

/// What guidance did: a chart of each active objective's value, and a table.
core::Markup guidanceSection(const record::SessionResult& result);

// The part of the page that a slider over time moves: the picture from above, the front view of
// each slot's CBV, speeds and commands at that time, and the controls.

/// What needs the script is hidden without it.
core::Markup stageHtml(const record::SessionResult& result, const MapCanvas& canvas);

// The session's frames as compact JSON for the page's time slider: pixels of the picture from
// above, whole degrees, 0.1 m/s; commands, gaps and times to collision of ego and CBVs; front
// views.

/// Frames are left out evenly when there would be more than 60 000 poses.
std::string playbackJson(const record::SessionResult& result, const MapCanvas& canvas);

// Who was CBV when: a row per slot over the session's time [s], a bar per stay, a ring where the
// CBV touched another vehicle.

/// As one HTML figure, for a session with CBVs.
core::Markup slotChart(const record::SessionResult& result);

// Charts of a session: speeds, distance between ego and CBVs, commands.

/// All charts with their common legend, as HTML.
core::Markup sessionCharts(const record::SessionResult& result);

}  // namespace cdiff::page
