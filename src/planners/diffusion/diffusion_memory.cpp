// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/diffusion/diffusion_memory.h"

#include <algorithm>

namespace cdiff::planners {

bool DiffusionMemory::takeImage() {
  const std::uint64_t hash = watch.imageHash();
  if (!features.empty() && features_hash_ == hash) return false;
  features_hash_ = hash;
  return true;
}

void DiffusionMemory::keepFeatures(std::uint64_t tick, std::uint64_t back) {
  if (back == 0) return;
  earlier_[tick] = features;
  earlier_.erase(earlier_.begin(), earlier_.lower_bound(tick - std::min(tick, back)));
}

const std::vector<float>* DiffusionMemory::featuresBefore(std::uint64_t tick,
                                                          std::uint64_t back) const {
  const auto kept = back > 0 && tick >= back ? earlier_.find(tick - back) : earlier_.end();
  return kept != earlier_.end() ? &kept->second : nullptr;
}

}  // namespace cdiff::planners
