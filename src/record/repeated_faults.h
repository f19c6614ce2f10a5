// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "e2e_cdiff/traffic/traffic_snapshot.h"

namespace cdiff::record {

/// A fault and how often it was noticed.
struct RepeatedFault {
  traffic::Fault fault;         ///< with the tick of the first time
  std::uint64_t last_tick = 0;  ///< of the last time
  std::size_t times = 1;

  /// The text, and where it was noticed again "(10 times, ticks 20 to 38)".
  std::string text() const;
};

/// Faults of equal source and text as one: a node may send the same bad command at every decision.
/// They are ordered by their last times, so the fault that ended a session stays the last.
std::vector<RepeatedFault> repeatedFaults(const std::vector<traffic::Fault>& faults);

}  // namespace cdiff::record
