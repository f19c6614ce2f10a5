// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The hand-made session with what a guided, seeing planner of the CBV would show: images, plans,
/// guidance.
#pragma once

#include <limits>

#include "record/sample_session.h"

namespace cdiff::test {

/// 160 x 96, left half red, right half blue.
inline traffic::CameraImage redAndBlue(std::uint64_t tick) {
  traffic::CameraImage image{160, 96, tick, {}};
  for (int i = 0; i < 160 * 96; ++i) {
    const bool red = i % 160 < 80;
    for (const int value : {red ? 255 : 0, 0, red ? 0 : 255}) {
      image.rgb.push_back(static_cast<std::uint8_t>(value));
    }
  }
  return image;
}

/// The plan of "bg_1": what it drives (north at 6 m/s), but drifting east by 0.25 m/s. Objective
/// "speed" is not a number at tick 60, "comfort" never is one.
inline planning::PlannedAction sampleAction(std::uint64_t tick) {
  const traffic::TrafficSnapshot snapshot = sampleSnapshot(tick);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  planning::PlannedAction action;
  action.slot = 0;
  action.vehicle_id = "bg_1";
  action.state_mismatch = tick == 52 ? 0.5 : 0.1;
  for (int i = 1; i <= 32; ++i) {
    planning::RolloutPoint point;
    point.state = snapshot.find("bg_1")->state;
    point.state.position += Eigen::Vector2d(0.025 * i, 0.6 * i);
    action.rollout.push_back(point);
  }
  // Straight on at 3.6, 4.2, 4.8 and 5.4 m/s.
  for (int i = 1; i <= 4; ++i) {
    planning::PlannedCandidate& candidate = action.candidates.emplace_back();
    candidate.score = 0.1 * i;
    candidate.chosen = i == 4;
    for (int step = 1; step <= 6; ++step) {
      candidate.places.push_back(snapshot.find("bg_1")->state.position +
                                 Eigen::Vector2d(0.0, (3.0 + 0.6 * i) * 0.5 * step));
    }
  }
  action.guidance.objectives = {{"speed", 1.5, tick == 60 ? nan : 2.0, 0.5, 0.25, 1},
                                {"comfort", 1.0, nan, nan, 0.0, 0}};
  action.guidance.trust_region_share = 0.125;
  return action;
}

/// Ticks 0 to 120 (6 s); the ego's planner sees nothing.
inline void playSeenSession(session::SessionObserver& observer,
                            const session::SessionSetup& setup) {
  for (std::uint64_t tick = 0; tick <= 120; ++tick) {
    traffic::TrafficSnapshot snapshot = sampleSnapshot(tick);
    if (tick == 120) snapshot.status = traffic::SessionStatus::kTimedOut;
    if (tick == 60) snapshot.faults = {{60, "cbv:diffusion", "x"}, {60, "ego:pdm_lite", "y"}};
    const cbv::CbvSelection selection = sampleSelection(tick, setup.network());
    std::vector<planning::PlannedAction> actions = {{-1, "ego", {}, {}}};
    std::vector<session::SlotImage> images;
    if (tick >= 52) actions.push_back(sampleAction(tick));
    if (tick >= 52) images.push_back({0, redAndBlue(tick)});
    session::TickRecord record;
    record.snapshot = &snapshot;
    if (snapshot.decision_tick) {
      record.selection = &selection;
      record.actions = &actions;
      record.images = &images;
    }
    observer.observe(record);
  }
}

}  // namespace cdiff::test
