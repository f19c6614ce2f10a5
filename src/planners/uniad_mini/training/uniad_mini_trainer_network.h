// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <vector>

#include "planners/camera_ego/training/bev_trainer_network.h"
#include "planners/camera_ego/training/ego_layers.h"
#include "planners/uniad_mini/motion_anchors.h"
#include "planners/uniad_mini/uniad_mini_weights.h"

namespace cdiff::planners {

// What the network answers for B moments, with gradients (body frame, SI units): A slots of
// tracks, R = A + 1 rows with the ego's, L lines, P = 10 points, M = 6 modes, C cells.

/// Where the track queries start that do not start as the learned ones.
struct TrackStart {
  at::Tensor held;  ///< [B, R, 1]: 1 where a track or the ego of before goes on; may be undefined
  at::Tensor content;    ///< [B, R, width]
  at::Tensor reference;  ///< [B, A, 2] logits of places as shares of the BEV
};

/// Track queries of one look.
struct TrackAnswer {
  std::vector<at::Tensor> logits;          ///< by decoder layer [B, A, 1]
  std::vector<at::Tensor> boxes;           ///< likewise [B, A, 10], kBoxNumbers in SI units
  std::vector<at::Tensor> ego_velocities;  ///< of the ego's own box, likewise [B, 2] [m/s]
  at::Tensor features;                     ///< [B, R, width]
  at::Tensor centers;                      ///< [B, R, 2] as shares of the BEV, without gradient
  at::Tensor content;                      ///< updated, for the look to come [B, R, width]
};

/// Map queries.
struct MapAnswer {
  std::vector<at::Tensor> logits;  ///< by decoder layer [B, L, kMapKinds]
  std::vector<at::Tensor> lines;   ///< likewise [B, L, P, 2] as shares of the BEV
  at::Tensor tokens;               ///< [B, L, width]
};

/// Motion of tracks and ego.
struct MotionAnswer {
  std::vector<at::Tensor> ways;     ///< by layer [B, R, M, 6, 2], from the row's center on [m]
  std::vector<at::Tensor> spreads;  ///< likewise [B, R, M, 6, 3]: logs of deviations, atanh of rho
  std::vector<at::Tensor> logits;   ///< likewise [B, R, M], by softmax
  at::Tensor modes;                 ///< features of the last layer [B, R, M, width]
};

/// What the queries of motion look at: the BEV, features of tracks with their places [B, R, width],
/// of the map's lines, and of each query's own track [B, R x M, width].
struct MotionSurroundings {
  at::Tensor bev, tracks, map, own;
};

/// The network of `uniad_mini` with gradients, in three parts; the same function as
/// UniadMiniNetwork.
class UniadMiniNet {
 public:
  UniadMiniNet(const UniadMiniArchitecture& architecture, std::uint64_t seed);
  UniadMiniNet(const UniadMiniNet&) = delete;
  UniadMiniNet& operator=(const UniadMiniNet&) = delete;

  /// `bev`: of BevNet, [B x C, width].
  TrackAnswer seeTracks(const at::Tensor& bev, std::int64_t samples, const TrackStart& start) const;
  MapAnswer seeMap(const at::Tensor& bev, std::int64_t samples) const;
  MotionAnswer forecast(const at::Tensor& bev, const TrackAnswer& tracks,
                        const MapAnswer& map) const;
  /// Logits [B, 5 steps, A, C]; `sure` [B, A]: 1 for the agents that are there.
  at::Tensor occupancy(const at::Tensor& bev, const TrackAnswer& tracks, const MotionAnswer& motion,
                       const at::Tensor& sure) const;
  /// [B, 6, 2] [m]; `commands` [B], whole numbers.
  at::Tensor plan(const at::Tensor& bev, const TrackAnswer& tracks, const MotionAnswer& motion,
                  const at::Tensor& commands) const;

  const BevNet& bev() const { return bev_; }
  learning::ParameterSet& bevParameters() { return bev_parameters_; }
  learning::ParameterSet& trackParameters() { return track_parameters_; }
  learning::ParameterSet& planParameters() { return plan_parameters_; }
  const UniadMiniArchitecture& architecture() const { return architecture_; }

  /// The clustered anchors, which training does not change.
  void setAnchors(const std::array<MotionAnchors, kMotionGroups>& anchors);
  /// All weights with the anchors, as the weight file holds them.
  WeightTensors values() const;
  /// Throws InputError naming a tensor that is missing or of another shape.
  void load(const WeightTensors& weights, const std::string& source);
  /// The same for image backbone and BEV encoder alone.
  void loadBev(const WeightTensors& weights, const std::string& source) {
    bev_parameters_.load(weights, source);
  }
  void moveTo(const at::Device& device);

 private:
  /// Contents for the look to come.
  at::Tensor updated(const at::Tensor& features, const at::Tensor& position) const;
  /// What a motion layer makes of queries x [B, R x M, width] whose modes end at `shares`.
  at::Tensor fuse(const std::string& name, const at::Tensor& x, const at::Tensor& shares,
                  const MotionSurroundings& around) const;
  /// Anchors at the rows' headings [B, R, M, 6, 2], and the queries' start [B, R, M, width].
  std::pair<at::Tensor, at::Tensor> startModes(const TrackAnswer& tracks) const;
  at::Tensor place(const at::Tensor& shares) const {
    return tracks_.mlp("place", 2.0 * shares - 1.0);
  }
  /// Deformable attention of x [B, N, width] to the BEV around places [B, N, 2] (shares).
  at::Tensor readBev(const std::string& name, const at::Tensor& x, const at::Tensor& shares,
                     const at::Tensor& bev) const;
  /// The state of the next occupancy step, from state [B, c, 48] and placed agents [B, A, width].
  at::Tensor nextState(const std::string& name, const at::Tensor& state, const at::Tensor& placed,
                       const at::Tensor& sure) const;
  /// Places of agents at an occupancy step as shares of the BEV [B, A, 2].
  at::Tensor agentShares(const TrackAnswer& tracks, const MotionAnswer& motion,
                         std::int64_t step) const;

  UniadMiniArchitecture architecture_;
  learning::ParameterSet bev_parameters_, track_parameters_, plan_parameters_;
  EgoLayers bev_layers_, tracks_, plans_;
  BevNet bev_;
  at::Tensor anchors_;  ///< [groups, M, 6, 2]
};

/// x [B, cells, channels] -> [B, cells, 9 x channels]: gatherNeighbors.
at::Tensor neighborsOf(const inference::MapGrid& grid, const at::Tensor& x);

}  // namespace cdiff::planners
