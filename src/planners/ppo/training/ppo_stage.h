// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "learning/task.h"
#include "planners/ppo/training/advantages.h"
#include "planners/ppo/training/collector.h"
#include "planners/ppo/training/ppo_networks.h"

namespace cdiff::planners {

/// Settings of PPO beside those of every training; defaults are RIFT's, with FREA's learning rate.
struct PpoSettings {
  std::string suite;              ///< route suite to learn on
  PpoCollectorOptions collector;  ///< its seed is the training's
  std::int64_t cbvs = 3;          ///< driven at a time
  std::int64_t passes = 4;        ///< over the buffer, in expectation
  double discount = 0.98;         ///< gamma
  double advantage_decay = 0.98;  ///< lambda
  double clip_ratio = 0.2;        ///< epsilon
  double entropy_weight = 0.01;
  std::int64_t held_out_rounds = 1;  ///< sessions on each held-out route
};

/// Time since some moment [s]: on the wall, and of the processors on this process.
struct PpoClocks {
  double wall = 0.0;
  double processors = 0.0;

  static PpoClocks now();
};

/// How a set of episodes went.
struct PpoEpisodeCounts {
  std::size_t episodes = 0;
  std::size_t decisions = 0;
  double total = 0.0;  ///< sum of returns
  std::size_t goals = 0;
  std::size_t ego_contacts = 0;
  std::size_t other_contacts = 0;

  explicit PpoEpisodeCounts(const std::vector<PpoEpisode>& all);
  /// Mean return, and shares of ends, with `prefix` before their names.
  learning::Measures measures(const std::string& prefix) const;
};

/// What a run of PPO holds.
struct PpoTraining {
  const learning::TrainingRun& run;
  const PpoSettings& settings;
  const PpoRoutes& routes;
  PpoNetworks networks;

  PpoCollector collector() const;
};

/// Proximal policy optimization (Schulman et al. 2017) as RIFT and FREA do it. An iteration
/// collects at least `buffer` decisions, and makes passes x buffer / minibatch steps on minibatches
/// drawn with replacement: loss = -min(A r, A clip(r, 1 - e, 1 + e)) - weight entropy + SmoothL1(V,
/// A + V_old), r the ratio of densities, A normalized over the buffer.
class PpoStage : public learning::Stage {
 public:
  explicit PpoStage(PpoTraining& training);

  const std::string& name() const override { return name_; }
  std::vector<learning::TrainedPart> parts() override;
  std::int64_t batchSize() const override;
  learning::StageRules rules() const override;
  /// Collects a new buffer at the first step of an iteration.
  learning::Loss loss(std::int64_t step) override;
  learning::Measures news() override;
  std::vector<std::size_t> samplesOf(std::int64_t step) override;
  /// tanh(mean) on the held-out networks.
  learning::Measures measureHeldOut() override;

 private:
  /// The decisions of an iteration as tensors.
  struct Buffer {
    std::int64_t iteration = -1;
    at::Tensor observations;  ///< [N, 24]
    at::Tensor actions;       ///< [N, 2]
    at::Tensor densities;     ///< [N] logarithms when collected
    at::Tensor advantages;    ///< [N] normalized
    at::Tensor returns;       ///< [N] A + V
  };
  std::int64_t stepsAnIteration() const;
  void collect(std::int64_t iteration);
  void notePace(const PpoClocks& begin);
  void fill(const std::vector<PpoEpisode>& episodes);
  std::vector<PpoValued> valued(const std::vector<PpoEpisode>& episodes,
                                const at::Tensor& observations) const;

  std::string name_ = kStage;
  PpoTraining& training_;
  Buffer buffer_;
  learning::Measures news_;
  PpoClocks begun_;            ///< when the last iteration was begun
  std::size_t decisions_ = 0;  ///< of it; 0: there was none

 public:
  static constexpr const char* kStage = "policy";
  static constexpr std::int64_t kBatch = 256;
};

}  // namespace cdiff::planners
