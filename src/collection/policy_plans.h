// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "collection/dataset_statistics.h"
#include "diffusion/model.h"
#include "diffusion/network/cpu_denoiser.h"
#include "diffusion/network/image_encoder.h"
#include "diffusion/sampler.h"
#include "dynamics/action_rollout.h"
#include "learning/samples/driving_sample.h"
#include "session/session_setup.h"

namespace cdiff::collection {

/// The return of a rollout (rows in the frame of the vehicle at its start, SI units) among what the
/// other vehicles then did: RIFT's reward (planners/rift/rift_reward.h) of its T states, discounted
/// by 0.98 a step, up to the first collision. A collision is an overlap of boxes on one level, off
/// the road is a corner of the box off the drivable area, offset and heading error are those from
/// the route. `future`: the snapshots of the T decisions that follow.
double rolloutReturn(const traffic::Rollout& rollout, const traffic::Vehicle& vehicle,
                     const SampleSurroundings& around,
                     const std::vector<const traffic::TrafficSnapshot*>& future);

/// exp(A / 0.5), at most 3, of each return's advantage A = (R - mean) / (sd + 1e-5) in its group
/// (advantage-weighted regression, Peng et al. 2019; the group's as in RIFT).
std::vector<double> returnWeights(const std::vector<double>& returns);

/// Draws unguided plans of a diffusion model for a sample and keeps one, by its return.
class PolicyPlans {
 public:
  /// `count` plans a sample. Throws InputError for a model that does not fit the samples.
  PolicyPlans(const std::string& model, std::int64_t count, const session::SessionSetup& setup);

  /// The sample with one of the plans as its rollout, drawn with returnWeights; its states are what
  /// the vehicle dynamics makes of the plan's actions. nullopt where all plans have the same
  /// return.
  std::optional<learning::DrivingSample> improved(
      const learning::DrivingSample& sample, const SampleSurroundings& around,
      const std::vector<const traffic::TrafficSnapshot*>& future);

 private:
  std::vector<traffic::Rollout> plansFor(const learning::DrivingSample& sample);

  std::int64_t count_;
  diffusion::Model model_;
  diffusion::NoiseSchedule schedule_;
  diffusion::ImageEncoder encoder_;
  diffusion::CpuDenoiser denoiser_;
  diffusion::Sampler sampler_;
  dynamics::ActionRollout dynamics_;
  core::RandomStream choice_;
};

}  // namespace cdiff::collection
