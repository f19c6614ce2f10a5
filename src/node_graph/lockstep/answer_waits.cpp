// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/lockstep/answer_waits.h"

#include <algorithm>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "core/file.h"

namespace cdiff::node_graph {

void AnswerWaits::published(std::uint64_t tick, Clock::time_point now) {
  tick_ = tick;
  published_at_ = now;
}

void AnswerWaits::arrived(const Topic& topic, std::uint64_t tick, Clock::time_point now) {
  if (tick != tick_) return;
  Sum& sum = sums_[topic.id];
  sum.milliseconds += std::chrono::duration<double, std::milli>(now - published_at_).count();
  ++sum.count;
}

std::map<std::string, double> AnswerWaits::means() const {
  std::map<std::string, double> means;
  for (const auto& [id, sum] : sums_) {
    std::string name = channel(id).name;
    std::replace(name.begin(), name.end(), '/', '_');
    means[name] = sum.milliseconds / static_cast<double>(sum.count);
  }
  return means;
}

void writeWaits(const std::map<std::string, double>& waits) {
  const char* file = std::getenv(kWaitsVariable);
  if (file == nullptr || *file == '\0') return;
  core::writeFileAtomically(file, nlohmann::json(waits).dump(2) + "\n");
}

}  // namespace cdiff::node_graph
