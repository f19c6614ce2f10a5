// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "learning/task.h"
#include "planners/camera_ego/training/ego_examples.h"

namespace cdiff::planners {

/// Which moments of scenes a camera ego learns from, and how they are changed.
struct EgoSampleOptions : PlutoSampleOptions {
  double balance = 0.5;          ///< weight n^-balance of a class of n moments
  double displaced_share = 0.5;  ///< part of the moments that are seen from beside the true place
  double displacement = 0.5;     ///< to either side, at most [m]
  double displaced_turn = 0.06;  ///< to either side, at most [rad]
  std::int64_t past_looks = 2;   ///< most looks before the present one, kPastAge apart
  bool blind = false;            ///< mid-gray images: shows what images are worth

  void describe(core::OptionsVisitor& visitor);
};

/// The moments of a training of a camera ego: scenes in memory, places in them, and the examples
/// made of them when a step asks.
class EgoData {
 public:
  /// The samples of a scene, which is kept.
  std::vector<learning::Sample> samplesOf(const learning::Scene& scene,
                                          const EgoSampleOptions& options);
  /// After all scenes: what the run learns from. `run` and `options` must outlive it; `labels`:
  /// how every example is made but for looks and displacement.
  void start(const learning::TrainingRun& run, const EgoSampleOptions& options,
             const rendering::CameraRig& rig, const BevGrid& bev,
             const EgoExampleOptions& labels = {});

  /// How often each training sample comes, mean 1: classes of command and pace are balanced.
  std::vector<double> weights() const;
  /// The examples of a step, displaced and with as many past looks as `random` says (`looks`: most
  /// of all looks; 1 leaves the past out).
  std::vector<EgoExample> examplesOf(const std::vector<std::size_t>& samples, std::int64_t step,
                                     const core::RandomStream& random, std::size_t looks);
  /// An example as it was, with the most looks.
  EgoExample exampleOf(std::size_t sample, std::size_t looks);
  /// Centers of the agents of up to `most` training samples, evenly chosen.
  std::vector<std::vector<Eigen::Vector2d>> agentCenters(std::size_t most);

 private:
  std::string classOf(const PlutoPlace& place) const;

  std::optional<PlutoWorlds> worlds_;
  std::vector<PlutoScene> scenes_;
  const learning::TrainingRun* run_ = nullptr;
  const EgoSampleOptions* options_ = nullptr;
  EgoExampleOptions labels_;
  mutable std::unique_ptr<EgoExamples> examples_;
  std::vector<PlutoPlace> places_;  ///< by index in the data set
};

}  // namespace cdiff::planners
