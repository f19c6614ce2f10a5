// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>
#include <vector>

#include "session/session_observer.h"
#include "session/steering.h"

namespace cdiff::record {

/// Collects what was steered in a session: each change with the tick of its snapshot, and whether
/// CBV identification took the vehicles that were chosen.
class SteeringLog {
 public:
  void observe(const session::TickRecord& record);
  /// In order.
  const std::vector<session::SteeringRecord>& records() const { return records_; }
  /// Whether any of it was no part of the scenario.
  bool byHand() const;

 private:
  std::vector<session::SteeringRecord> records_;
};

/// "profile naturalistic -> safety_critical", "choose car" for people.
std::string steeringText(const session::SteeringRecord& record);

}  // namespace cdiff::record
