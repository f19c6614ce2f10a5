// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "record/session_text.h"

#include <algorithm>
#include <map>
#include <set>

#include "cbv/candidate_gates.h"
#include "cbv/cbv_selector.h"
#include "core/markup.h"
#include "core/text.h"
#include "metrics/known_measures.h"
#include "record/logs/cbv_log.h"
#include "record/repeated_faults.h"
#include "record/verdict.h"
#include "session/session_request.h"

namespace cdiff::record {
namespace {

using Texts = std::map<std::string, std::string>;

std::string textOf(const Texts& texts, const std::string& word) {
  const auto found = texts.find(word);
  return found == texts.end() ? word : found->second;
}

}  // namespace

std::string rejectionText(const std::string& reason) {
  static const Texts kTexts = {
      {cbv::kNotNamed, "cbv.only does not name it"},
      {cbv::kTooSmall, "it is a pedestrian, a bicycle or a small object"},
      {cbv::kAlreadyChosen, "it was a CBV before, and the life cycle takes none twice"},
      {cbv::kInContact, "it touches another vehicle and is about to be removed"},
      {cbv::kTooFar, "it is farther from the ego than cbv.search_radius"},
      {cbv::kTooNear, "it is nearer to the ego than cbv.minimum_distance"},
      {cbv::kOtherLevel, "it drives above or below the ego"},
      {cbv::kOffLane, "it is on no lane of its direction"},
      {cbv::kQueued, "it waits on a lane of the ego's route, in the same queue"},
      {cbv::kContactAhead, "it would touch another vehicle within cbv.clear_time"},
      {cbv::kJunctionHeading, "it stands askew to the lanes of its junction"},
      {cbv::kOutOfView, "no point of the ego's route lies near and ahead of it"},
      {cbv::kNoWay, "no lanes lead it to the ego's route"},
      {cbv::kDistanceMismatch, "it and the ego have too different distances to where they meet"},
      {cbv::kOutranked, "it has a conflict, but better candidates took the slots"}};
  return textOf(kTexts, reason);
}

std::string releaseText(const std::string& reason) {
  static const Texts kTexts = {{cbv::kContact, "touched another vehicle"},
                               {cbv::kRouteEnd, "reached the end of its conflict-aware route"},
                               {cbv::kGone, "left the simulation"},
                               {cbv::kConflictLost, "its conflict was lost"},
                               {cbv::kOutranked, "a better candidate took the slot"},
                               {cbv::kSteered, "steering took it out of the slot"},
                               {kSessionEnd, "the session ended"}};
  return textOf(kTexts, reason);
}

std::string untestedText(const SessionResult& result) {
  const bool asked = result.setup.options().max_cbv > 0;
  if (!asked || !result.cbv.records().empty() || !endedByItself(result.status)) return "";
  return "0 CBVs: nothing was tested: no vehicle was ever taken as CBV";
}

namespace {

std::string drivenRoute(const SessionResult& result) {
  if (result.timeline.frames().empty()) return "The session ended before its first tick.";
  return "The ego drove " +
         core::formatFixed(result.measures.number(metrics::known::kRouteCompletion), 1) +
         " % of its route in " + core::formatFixed(result.simulated_seconds, 1) + " s.";
}

std::string approach(const SessionResult& result) {
  if (const std::string untested = untestedText(result); !untested.empty()) return untested + ".";
  std::set<std::string> vehicles;
  for (const CbvRecord& record : result.cbv.records()) vehicles.insert(record.vehicle_id);
  if (vehicles.empty()) return "No vehicle was selected as CBV.";
  const std::string count = vehicles.size() == 1
                                ? *vehicles.begin() + " was the only CBV"
                                : std::to_string(vehicles.size()) + " vehicles were CBVs";
  const auto& gap = result.timeline.smallestGap();
  if (!gap) return count + "; none was driven on the ego's level.";
  const std::string who = vehicles.size() == 1 ? " and came" : "; " + gap->vehicle_id + " came";
  if (gap->distance <= 0.0) {
    return count + who + " into contact at " + core::formatFixed(gap->time, 2) + " s.";
  }
  return count + who + (vehicles.size() == 1 ? " as near as " : " nearest, ") +
         core::formatFixed(gap->distance, 2) + " m between the outlines, at " +
         core::formatFixed(gap->time, 2) + " s.";
}

std::string contact(const SessionResult& result) {
  const std::vector<metrics::EgoContact>& contacts = result.measures.ego_contacts;
  if (contacts.empty()) return "No vehicle touched the ego.";
  const metrics::EgoContact& first = contacts.front();
  return "The ego and " + partnerText(first) + " touched at " +
         core::formatFixed(first.seconds, 2) + " s" +
         (contacts.size() > 1
              ? ", the first of " + std::to_string(contacts.size()) + " contacts of the ego"
              : "") +
         "; " + faultText(result.setup.options(), contacts) + ".";
}

/// Empty unless the session ended blocked or timed out.
std::string holdUp(const SessionResult& result) {
  const std::optional<HoldUp>& found = result.hold_ups.found();
  return found ? holdUpText(*found, result.setup, result.status) : "";
}

}  // namespace

std::vector<std::string> sessionStory(const SessionResult& result) {
  if (result.timeline.frames().empty()) return {drivenRoute(result)};
  std::vector<std::string> story = {drivenRoute(result)};
  if (const std::string cause = holdUp(result); !cause.empty()) story.push_back(cause);
  story.push_back(approach(result));
  story.push_back(contact(result));
  return story;
}

namespace {

constexpr std::size_t kNameWidth = 24;

/// Names and values may be those of plug-ins, nodes and files of others.
std::string row(const std::string& name, const std::string& value) {
  std::string text = "  " + name;
  text.resize(std::max(text.size() + 1, kNameWidth + 2), ' ');
  return core::plainText(text + value) + "\n";
}

std::string holdUpRow(const SessionResult& result) {
  const std::string cause = holdUp(result);
  return cause.empty() ? "" : row("  held up by", cause);
}

std::string headRows(const SessionResult& result) {
  const session::ScenarioOptions& options = result.setup.options();
  std::string time = core::formatFixed(result.simulated_seconds, 2) + " s simulated in " +
                     core::formatFixed(result.wall_seconds, 2) + " s";
  if (result.wall_seconds > 0.0) {
    time += " (" + core::formatFixed(result.simulated_seconds / result.wall_seconds, 1) +
            " times real time)";
  }
  return row("scenario",
             options.name + ", seed " + std::to_string(options.seed) + ", " + options.mode) +
         row("planners", "ego " + options.ego_planner + ", CBV " + options.cbv_planner) +
         row("method", session::methodText(session::methodOf(options))) +
         row("status", traffic::toText(result.status)) + holdUpRow(result) + row("time", time);
}

std::string measureRows(const SessionResult& result) {
  const metrics::SessionMeasures& measures = result.measures;
  namespace known = metrics::known;
  const auto count = [&](const metrics::MeasureDefinition& definition) {
    return std::to_string(measures.count(definition));
  };
  const auto text = [&](const metrics::MeasureDefinition& definition) {
    return measureText(measures.at(definition), 2);
  };
  const auto fixed = [&](const metrics::MeasureDefinition& definition) {
    return core::formatFixed(measures.number(definition), 1);
  };
  return row("route completion", fixed(known::kRouteCompletion) + " %") +
         row("driving score", fixed(known::kDrivingScore) + " by " + measures.protocol +
                                  ", penalty " + measureText(measures.at(known::kPenalty), 3)) +
         row("ego collisions", count(known::kEgoCollisions)) +
         row("  who struck whom", "ego struck CBVs " + count(known::kEgoStruckCbvs) +
                                      ", CBVs struck ego " + count(known::kEgoStruckByCbvs) +
                                      "; ego standing " + count(known::kEgoStruckStanding) +
                                      ", braking avoids " + count(known::kEgoBrakingAvoids) +
                                      "; in " + fixed(known::kEgoDistance) + " m") +
         row("CBVs", count(known::kCbvCount) + " over " + count(known::kCbvDecisions) +
                         " decisions" +
                         (untestedText(result).empty() ? "" : ": NOTHING WAS TESTED")) +
         row("CBV collisions", count(known::kCbvCollisions) + " (" +
                                   count(known::kCbvEgoCollisions) + " with the ego)") +
         row("CBV off-road rate", text(known::kCbvOffRoad)) +
         row("CBV wrong-way driving", text(known::kCbvWrongWay)) +
         row("CBVs standing", count(known::kCbvStanding) + " on a free road for more than 3 s") +
         row("collisions per km", text(known::kCollisionsPerKm)) +
         row("2D-TTC mean", text(known::kTtcMean)) +
         row("2D-TTC minimum", text(known::kTtcMinimum));
}

/// Wall time from image (or snapshot) to command.
std::string latencyRows(const std::map<std::string, LatencySummary>& latencies) {
  std::string text;
  for (const auto& [planner, summary] : latencies) {
    text += row("latency " + planner, "p50 " + core::formatFixed(summary.median, 1) + " ms, p95 " +
                                          core::formatFixed(summary.percentile_95, 1) +
                                          " ms (n = " + std::to_string(summary.n) + ")");
  }
  return text;
}

/// How many faults there were and the first few, each in one line.
std::string faultRows(const std::vector<RepeatedFault>& faults) {
  constexpr std::size_t kShown = 3;
  constexpr std::size_t kLetters = 300;
  if (faults.empty()) return "";
  std::string text = row("faults", std::to_string(faults.size()));
  for (std::size_t i = 0; i < std::min(kShown, faults.size()); ++i) {
    std::string line = core::cutText(faults[i].fault.source + ": " + faults[i].text(), kLetters);
    std::replace(line.begin(), line.end(), '\n', ' ');
    text += row("", "- " + line);
  }
  if (faults.size() > kShown)
    text += row("", "- " + std::to_string(faults.size() - kShown) + " more in summary.json");
  return text;
}

}  // namespace

std::string measureText(const metrics::Measure& measure, int decimals) {
  if (!measure.value) {
    return "not defined" + (measure.reason.empty() ? std::string() : ": " + measure.reason);
  }
  return core::formatFixed(*measure.value, decimals) +
         (measure.unit.empty() ? "" : " " + measure.unit) + " (n = " + std::to_string(measure.n) +
         ")";
}

std::string sessionTable(const SessionResult& result, const std::filesystem::path& folder) {
  std::string text = headRows(result) + measureRows(result) + latencyRows(result.latencies);
  const std::string late = latenessText(result.late);
  if (!late.empty()) text += row("late answers", late);
  for (const session::SteeringRecord& record : result.steering.records())
    text += row("steered", steeringText(record));
  text += faultRows(repeatedFaults(result.faults));
  text += row("verdict", capitalsOf(result.verdict.outcome));
  for (const std::string& reason : result.verdict.reasons) text += row("", "- " + reason);
  return text + row("report", (folder / "report.html").string()) + row("results", folder.string());
}

std::string fileRow(const std::string& name, const std::filesystem::path& file) {
  std::error_code ignored;
  return std::filesystem::exists(file, ignored) ? row(name, file.string()) : "";
}

}  // namespace cdiff::record
