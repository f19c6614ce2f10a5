// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <array>
#include <deque>
#include <optional>
#include <vector>

#include "planners/camera_ego/bev_encoder.h"

namespace cdiff::planners {

/// The tracks of one decision, as the decision half a second later starts from them. A slot is a
/// query: the learned one, or in its place a track.
struct TrackSet {
  std::vector<bool> live;                   ///< by slot: whether it holds a track
  std::vector<Eigen::Vector2d> centers;     ///< by slot, body frame of the ego then [m]
  std::vector<Eigen::Vector2d> velocities;  ///< likewise [m/s]
  inference::Rows content;                  ///< updated features by slot, the ego's last
};

/// Whether a slot holds a track after a decision: a new one is born at kBirthScore, an old one
/// lives at kKeepScore. `score`: probability.
bool holdsTrack(bool held, double score);

/// Where a slot's vehicle is kPastAge after `poses.past` if it keeps its velocity (body frame of
/// the present ego); nullopt for a slot without a track, and where that is beyond the BEV.
std::optional<Eigen::Vector2d> movedCenter(const TrackSet& tracks, std::size_t slot,
                                           const EgoPoses& poses, const BevGrid& bev);

/// Logits of a place's shares of the BEV, as references of queries are.
std::array<float, 2> referenceAt(const BevGrid& bev, const Eigen::Vector2d& place);

/// The tracks of the last half second, of which those of kPastAge ago are read, beside a
/// BevMemory: five chains of tracks that take turns. One per vehicle.
class TrackMemory {
 public:
  /// `period`: between decisions [s]; kPastAge is a multiple of it.
  explicit TrackMemory(double period);
  /// nullptr where nothing is that old.
  const TrackSet* past() const;
  /// Ends the decision.
  void keep(TrackSet tracks);
  /// After a decision without tracks nothing before it is trusted.
  void forget() { kept_.clear(); }

 private:
  std::size_t age_;  ///< kPastAge in decisions
  std::deque<TrackSet> kept_;
};

}  // namespace cdiff::planners
