// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "page/pictures/map_canvas.h"
#include "record/logs/cbv_log.h"
#include "record/logs/driving_log.h"
#include "record/verdict.h"
#include "session/session_observer.h"

namespace cdiff::page {

// The page that shows a session while it runs: the report's player, without the past, and with the
// session's controls. Its script (assets/live.js) fills it from what a socket beside it tells.

/// The document.
std::string livePage(const session::SessionSetup& setup);
/// Its Content-Security-Policy, and that of a report served beside it: nothing but what is in it,
/// and a socket to `host` ("127.0.0.1:8080").
std::string livePagePolicy(const std::string& host);

/// What the page shows beside a tick's snapshot; it changes at decisions and contacts.
struct LiveDecision {
  std::vector<planning::PlannedAction> actions;   ///< of the last decision, without images
  std::vector<cbv::CbvAssignment> assignments;    ///< of the last decision
  std::vector<std::string> cbvs;                  ///< all so far, in order of selection
  std::vector<record::TimelineContact> contacts;  ///< all so far
};

/// What the page shows of a tick: a copy, so that it can be drawn while the session goes on.
struct LiveTick {
  traffic::TrafficSnapshot snapshot;
  std::shared_ptr<const LiveDecision> decision;
};

/// What the charts and trails of the page show of a time: ego and CBVs.
struct LivePoint {
  struct Vehicle {
    std::string id;
    std::size_t style = 0;  ///< number of its style, as cbvStyleNumber has it
    record::TimelinePose pose;
    double score = -1.0;  ///< interaction score at selection, [0, 1]; negative: none
  };
  double time = 0.0;  ///< [s]
  std::vector<Vehicle> vehicles;
};

/// Writes ticks and points as the page's script reads them. Knows a vehicle by an index from the
/// first frame on that has it.
class LiveWriter {
 public:
  /// `setup` must outlive the object.
  explicit LiveWriter(const session::SessionSetup& setup);
  nlohmann::ordered_json frame(const LiveTick& tick);
  nlohmann::ordered_json point(const LivePoint& point) const;
  /// null for a vehicle that no frame has had yet.
  nlohmann::ordered_json view(const record::FrontView& view) const;
  /// The verdict so far, as if nobody had steered: `style` of its banner, `text`, and its rules.
  /// `by_hand`: whether somebody has.
  static nlohmann::ordered_json verdict(const record::Verdict& so_far, bool by_hand);

 private:
  MapCanvas canvas_;
  record::Timeline index_;
};

}  // namespace cdiff::page
