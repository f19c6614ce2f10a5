// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// What became of every vehicle that was selected as CBV: where and when, for how many decisions,
/// why released; and how often which reason rejected a candidate.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "e2e_cdiff/cbv/cbv_selection.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"

namespace cdiff::report {

/// Reason of a CBV that was still driven when the session ended.
inline constexpr const char* kSessionEnd = "session_end";

/// One stay of a vehicle in a slot.
struct CbvRecord {
  int slot = 0;
  std::string vehicle_id;
  std::uint64_t selected_tick = 0;
  double interaction_score = 0.0;
  cbv::ConflictPoint conflict_point;  ///< as of the selection
  std::size_t decisions_driven =
      0;  ///< decisions that found it driven as CBV: not yet that of its selection
  std::optional<std::uint64_t> released_tick;  ///< absent when the session ended first
  std::string release_reason = kSessionEnd;
  double route_length = 0.0;           ///< of the conflict-aware route [m]
  std::vector<Eigen::Vector3d> route;  ///< points of the conflict-aware route, map frame [m]
};

class CbvLog {
 public:
  /// One decision in order.
  void observe(const traffic::TrafficSnapshot& snapshot, const cbv::CbvSelection& selection);
  /// In order of selection.
  const std::vector<CbvRecord>& records() const { return records_; }
  /// Candidates rejected, over all decisions, by reason.
  const std::map<std::string, std::size_t>& rejected() const { return rejected_; }

 private:
  CbvRecord& recordOf(const cbv::CbvAssignment& assignment);
  void close(const cbv::CbvSelection& selection);

  std::vector<CbvRecord> records_;
  std::map<int, std::size_t> open_;  ///< slot -> index of its present record
  std::map<std::string, std::size_t> rejected_;
};

}  // namespace cdiff::report
