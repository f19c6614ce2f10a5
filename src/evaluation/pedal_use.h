// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "dynamics/throttle_response.h"
#include "record/result_folder.h"

namespace cdiff::evaluation {

// Which pedals CBVs were driven with, from traces: the dynamics responds to a throttle in the notch
// [0.3, u_0(v)) by braking, so that averages of "coast" and "hold" slow the car
// (dynamics/throttle_response.h).

/// Bins of the throttle, equally wide over [0, 1].
inline constexpr std::size_t kThrottleBins = 20;

/// Executed pedals of CBVs, counted by tick: what they did at the speed before the tick, and the
/// throttle [0, 1] where the brake did not act.
class PedalCounts {
 public:
  /// `rows` in the trace's order. A tick counts where the vehicle was in the trace one tick before.
  void add(const std::vector<record::TraceRow>& rows);

  std::size_t ticks() const { return ticks_; }
  /// Ticks of a use.
  std::size_t count(dynamics::PedalUse use) const;
  /// Mean acceleration by the pedals in the first 0.05 s of ticks of a use [m/s^2]; 0 without any.
  double meanAcceleration(dynamics::PedalUse use) const;
  /// Ticks by throttle; those with the brake are not among them.
  const std::array<std::size_t, kThrottleBins>& throttles() const { return throttles_; }

 private:
  struct Use {
    std::size_t ticks = 0;
    double acceleration_sum = 0.0;  ///< [m/s^2]
  };
  void addTick(double speed, const traffic::ControlAction& action);

  dynamics::BicycleModel model_;
  std::size_t ticks_ = 0;
  std::map<dynamics::PedalUse, Use> uses_;
  std::array<std::size_t, kThrottleBins> throttles_{};
};

/// The counts of a result folder: of a session under its name; of a batch by the levels of the
/// factors that vary, but scenario, seed and repetition. Throws InputError for a folder that is
/// neither, and where no run is complete.
std::map<std::string, PedalCounts> pedalCounts(const std::filesystem::path& results);

/// The counts as Markdown: shares by use, and the histogram of the throttle.
std::string pedalMarkdown(const std::map<std::string, PedalCounts>& counts);

}  // namespace cdiff::evaluation
