// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/uniad_mini/track_set.h"

#include <algorithm>
#include <cmath>

#include "planners/uniad_mini/uniad_mini_weights.h"

namespace cdiff::planners {

bool holdsTrack(bool held, double score) { return score >= (held ? kKeepScore : kBirthScore); }

std::optional<Eigen::Vector2d> movedCenter(const TrackSet& tracks, std::size_t slot,
                                           const EgoPoses& poses, const BevGrid& bev) {
  if (!tracks.live[slot] || !poses.past) return std::nullopt;
  const Eigen::Vector2d there = tracks.centers[slot] + kPastAge * tracks.velocities[slot];
  const Eigen::Vector2d here = poses.present.toBody(poses.past->toMap(there));
  if (!here.allFinite() || !bev.contains(here)) return std::nullopt;
  return here;
}

std::array<float, 2> referenceAt(const BevGrid& bev, const Eigen::Vector2d& place) {
  constexpr double kLeast = 1e-3;
  const Eigen::Vector2d share = bev.toShare(place);
  const auto logit = [&](double part) {
    const double p = std::clamp(part, kLeast, 1.0 - kLeast);
    return static_cast<float>(std::log(p / (1.0 - p)));
  };
  return {logit(share.x()), logit(share.y())};
}

TrackMemory::TrackMemory(double period)
    : age_(static_cast<std::size_t>(std::lround(kPastAge / period))) {}

const TrackSet* TrackMemory::past() const {
  return kept_.size() >= age_ ? &kept_[kept_.size() - age_] : nullptr;
}

void TrackMemory::keep(TrackSet tracks) {
  if (kept_.size() >= age_) kept_.pop_front();
  kept_.push_back(std::move(tracks));
}

}  // namespace cdiff::planners
