// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "record/session_story.h"

#include <map>
#include <set>

#include "cbv/candidate_gates.h"
#include "cbv/held_cbv.h"
#include "core/text.h"
#include "metrics/known_figures.h"
#include "record/logs/cbv_log.h"

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
      {cbv::kAlreadyChosen, "it was a CBV before, and the life cycle takes none twice"},
      {cbv::kInContact, "it touches another vehicle and is about to be removed"},
      {cbv::kTooFar, "it is farther from the ego than cbv.search_radius"},
      {cbv::kTooNear, "it is nearer to the ego than cbv.minimum_distance"},
      {cbv::kOtherLevel, "it drives above or below the ego"},
      {cbv::kOffLane, "it is on no lane of its direction"},
      {cbv::kJunctionHeading, "it stands askew to the lanes of its junction"},
      {cbv::kOutOfView, "no point of the ego's route lies near and ahead of it"},
      {cbv::kNoWay, "no way along lanes leads it to the ego's route"},
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
                               {kSessionEnd, "the session ended"}};
  return textOf(kTexts, reason);
}

namespace {

std::string way(const SessionResult& result) {
  if (result.timeline.frames().empty()) return "The session ended before its first tick.";
  return "The ego drove " +
         core::formatFixed(result.measures.number(metrics::figures::kRouteCompletion), 1) +
         " % of its route in " + core::formatFixed(result.simulated_seconds, 1) + " s.";
}

std::string approach(const SessionResult& result) {
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
  if (contacts.empty()) return "Nobody touched the ego.";
  const metrics::EgoContact& first = contacts.front();
  return first.partner + " and the ego touched at " + core::formatFixed(first.seconds, 2) + " s" +
         (contacts.size() > 1
              ? ", the first of " + std::to_string(contacts.size()) + " contacts of the ego"
              : "") +
         (first.ego_at_fault ? "; the ego was at fault." : "; the ego was not at fault.");
}

}  // namespace

std::vector<std::string> sessionStory(const SessionResult& result) {
  if (result.timeline.frames().empty()) return {way(result)};
  return {way(result), approach(result), contact(result)};
}

}  // namespace cdiff::record
