// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "ros/tick_messages.h"

namespace cdiff::ros {

AnyMessage TickMessages::find(const Topic& topic) const {
  const auto found = messages_.find(topic);
  return found == messages_.end() ? nullptr : found->second;
}

bool TickMessages::holds(ChannelId id) const {
  const auto first = messages_.lower_bound({id, kEgoSlot});
  return first != messages_.end() && first->first.id == id;
}

AnyMessage makeMessage(const Topic& topic, const TickValues& values) {
  const MakeMessage make = topic.row().make;
  return make == nullptr ? nullptr : make(values, topic.slot);
}

TickMessages makeMessages(const TickValues& values, int max_cbv) {
  TickMessages messages;
  for (const Channel& row : channels()) {
    for (const Topic& topic : topicsOf(row, max_cbv)) {
      if (const AnyMessage message = makeMessage(topic, values)) messages.add(topic, message);
    }
  }
  return messages;
}

std::optional<Answer> readAnswer(const TickMessages& tick, int slot, const std::string& vehicle_id,
                                 const TickReading& reading) {
  if (!tick.find(controlOf(slot))) return std::nullopt;
  Answer answer;
  answer.action.slot = slot;
  answer.action.vehicle_id = vehicle_id;
  const Scope other = slot == kEgoSlot ? Scope::kSlot : Scope::kEgo;
  for (const Channel& row : channels()) {
    if (row.take == nullptr || row.scope == other) continue;
    const Topic topic(row.id, row.scope == Scope::kSlot ? slot : kEgoSlot);
    if (const AnyMessage message = tick.find(topic)) row.take(message, reading, answer);
  }
  return answer;
}

}  // namespace cdiff::ros
