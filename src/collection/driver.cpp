// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "collection/driver.h"

#include "e2e_cdiff/core/random.h"

namespace cdiff::collection {
namespace {

// Elements of a vehicle's style.
constexpr std::uint32_t kTargetSpeed = 0;
constexpr std::uint32_t kGap = 1;
constexpr std::uint32_t kHeadway = 2;
constexpr std::uint32_t kAcceleration = 3;
constexpr std::uint32_t kDeceleration = 4;

planners::DrivingStyle styleOf(const CollectionOptions& options, const core::RandomStream& random,
                               const core::RandomKey& key) {
  planners::DrivingStyle style;
  style.minimum_gap = random.uniform(key, kGap, style.minimum_gap, options.maximum_gap);
  style.time_headway = random.uniform(key, kHeadway, style.time_headway, options.maximum_headway);
  if (options.pedals == "published") return style;
  style.acceleration = random.uniform(key, kAcceleration, options.minimum_acceleration,
                                      options.maximum_acceleration);
  style.deceleration = random.uniform(key, kDeceleration, options.minimum_deceleration,
                                      options.maximum_deceleration);
  return style;
}

}  // namespace

Driver driverOf(const CollectionOptions& options, std::uint64_t seed,
                const std::string& vehicle_id) {
  const core::RandomStream random(seed, "collection_target_speed");
  const core::RandomKey key{core::hashText(vehicle_id), 0, 0};
  return {random.uniform(key, kTargetSpeed, options.minimum_speed, options.maximum_speed),
          styleOf(options, random, key)};
}

}  // namespace cdiff::collection
