// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "ros/channel_table.h"

#include "core/text.h"
#include "ros/channels.h"

namespace cdiff::ros {
namespace {

std::string partyText(Party party) {
  SessionGraph graph;
  if (party == Party::kParticipants) return "all but the simulator";
  if (party == Party::kCbvPlanner) return "planner of the CBVs";
  if (party == Party::kEgoPlanner) return "planner of the ego";
  return "`" + nodeOf(party, graph) + "`";
}

std::string under(const Condition& condition) {
  return std::string(condition.text).empty() ? "" : std::string(" ") + condition.text;
}

std::string listenersText(const Channel& row) {
  std::vector<std::string> texts;
  for (const Listener& listener : row.listeners)
    texts.push_back(partyText(listener.party) + under(listener.when));
  return core::joinText(texts, ", ");
}

std::string needText(Need need) {
  switch (need) {
    case Need::kNothing:
      return "";
    case Need::kDecision:
      return "at decisions";
    case Need::kVehicle:
      return "of each vehicle asked for";
    case Need::kSight:
      return "of each vehicle whose planner saw";
    case Need::kAnyCbv:
      return "where there is a CBV";
    case Need::kRecord:
      return "at decisions; it names what else came";
  }
  return "";
}

std::string recordedText(Recorded recorded) {
  switch (recorded) {
    case Recorded::kNever:
      return "";
    case Recorded::kOnce:
      return "once";
    case Recorded::kTick:
      return "every tick";
    case Recorded::kDecision:
      return "at decisions";
  }
  return "";
}

}  // namespace

std::string channelTable() {
  std::string text =
      "| Topic | Type | Published by | Listeners | A listener's tick waits for it | In the bag | "
      "Meaning |\n|---|---|---|---|---|---|---|\n";
  for (const Channel& row : channels()) {
    const std::string name = row.name;
    text += "| `" + (name.front() == '/' ? name : "/" + name) + "` | `" + row.type.name + "`" +
            (row.latched ? ", latched" : "") + " | " + partyText(row.publisher) +
            under(row.published) + " | " + listenersText(row) + " | " + needText(row.need) + " | " +
            recordedText(row.recorded) + " | " + row.help + " |\n";
  }
  return text;
}

}  // namespace cdiff::ros
