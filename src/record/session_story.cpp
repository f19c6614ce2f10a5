// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "record/session_story.h"

#include <set>

#include "core/text.h"
#include "metrics/known_figures.h"

namespace cdiff::record {
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
