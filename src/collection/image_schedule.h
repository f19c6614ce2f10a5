// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// When a driven vehicle's front view is recorded: once a period, slot after slot, and soon after a
/// disturbance of it, for what it does then is worth more than what it does most of the time.
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "e2e_cdiff/traffic/vehicle.h"

namespace cdiff::collection {

class ImageSchedule {
 public:
  /// `period`: decisions between two images of a vehicle; at least one is taken.
  explicit ImageSchedule(std::int64_t period);

  /// Whether the vehicle of a slot (-1: the ego) has its turn at the decision of this number; call
  /// once for each. `noisy`: its action of this decision carries noise. Never at the take-over
  /// itself, so that no jump lies between image and motion.
  bool due(const traffic::Vehicle& vehicle, int slot, std::int64_t decision, bool noisy);

 private:
  std::int64_t period_;
  std::map<std::string, std::int64_t> disturbed_;  ///< last decision with noise or take-over
};

}  // namespace cdiff::collection
