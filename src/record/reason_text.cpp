// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "record/reason_text.h"

#include <map>

#include "cbv/held_cbv.h"
#include "cbv/rejection_reason.h"
#include "record/cbv_log.h"

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

}  // namespace cdiff::record
