// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "session/target_speed.h"

#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/core/random.h"

namespace cdiff::session {

void CbvSpeedOptions::describe(core::OptionsVisitor& visitor) {
  visitor.text({"distribution", "", "fixed: target_speed for all; normal: one draw per CBV."},
               distribution, {"fixed", "normal"});
  visitor.number({"mean", "m/s", "Mean of the normal distribution."}, mean, 0.5, 40.0);
  visitor.number({"deviation", "m/s", "Its standard deviation before the cut."}, deviation, 0.01,
                 20.0);
  visitor.number({"lowest", "m/s", "Slower draws are repeated."}, lowest, 0.5, 40.0);
  visitor.number({"highest", "m/s", "Faster draws are repeated."}, highest, 0.5, 40.0);
}

void CbvSpeedOptions::validate() const {
  if (mean < lowest || mean > highest) {
    throw core::InputError("key 'cbv_target_speed.mean' is " + core::formatNumber(mean) +
                           " m/s; expected a speed in [lowest, highest] = [" +
                           core::formatNumber(lowest) + ", " + core::formatNumber(highest) + "]");
  }
  if (highest - lowest >= deviation) return;
  throw core::InputError(
      "key 'cbv_target_speed.deviation' is " + core::formatNumber(deviation) +
      " m/s; expected at most highest - lowest = " + core::formatNumber(highest - lowest));
}

/// Of a range that holds the mean and is as wide as the deviation at least a third of the draws lie
/// inside, so that the loop ends.
double cbvTargetSpeed(const CbvSpeedOptions& options, double fixed, std::uint64_t seed,
                      const std::string& vehicle_id) {
  if (!options.drawn()) return fixed;
  const core::RandomStream random(seed, "cbv_target_speed");
  const core::RandomKey key{core::hashText(vehicle_id), 0, 0};
  for (std::uint32_t element = 0;; ++element) {
    const double speed = options.mean + options.deviation * random.normal(key, element);
    if (speed >= options.lowest && speed <= options.highest) return speed;
  }
}

}  // namespace cdiff::session
