// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <string>

#include "node_graph/messages/topics.h"

namespace cdiff::node_graph {

/// How long the traffic simulator waited for the answers to its ticks, by channel: wall time from a
/// snapshot to the handling of each answer to it.
class AnswerWaits {
 public:
  using Clock = std::chrono::steady_clock;

  /// A tick was published.
  void published(std::uint64_t tick, Clock::time_point now = Clock::now());
  /// An answer to a tick has come; those to earlier ticks do not count.
  void arrived(const Topic& topic, std::uint64_t tick, Clock::time_point now = Clock::now());
  /// Mean waits [ms] by the channel's name with '_' for '/', as in "cbv_selection".
  std::map<std::string, double> means() const;

 private:
  struct Sum {
    double milliseconds = 0.0;
    std::uint64_t count = 0;
  };
  std::uint64_t tick_ = 0;
  Clock::time_point published_at_;
  std::map<ChannelId, Sum> sums_;
};

/// Names a file in the environment that gets the mean waits of a session as JSON
/// (`scripts/benchmark graph` reads it).
inline constexpr const char* kWaitsVariable = "E2E_CDIFF_WAITS_FILE";
/// Writes that file where the variable names one. Throws InputError when it cannot be written.
void writeWaits(const std::map<std::string, double>& waits);

}  // namespace cdiff::node_graph
