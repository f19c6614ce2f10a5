// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "collection/image_schedule.h"

#include <algorithm>

namespace cdiff::collection {

ImageSchedule::ImageSchedule(std::int64_t period) : period_(std::max<std::int64_t>(1, period)) {}

bool ImageSchedule::due(const traffic::Vehicle& vehicle, int slot, std::int64_t decision,
                        bool noisy) {
  const bool taken_over = !vehicle.applied_action;
  if (noisy || taken_over) disturbed_[vehicle.id] = decision;
  if (taken_over) return false;
  const auto disturbed = disturbed_.find(vehicle.id);
  const std::int64_t since = disturbed == disturbed_.end() ? 0 : decision - disturbed->second;
  return since == 1 || since == 4 || (decision + slot + 1) % period_ == 0;
}

}  // namespace cdiff::collection
