// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>

#include "diffusion/noise_schedule.h"
#include "learning/curve_log.h"
#include "learning/task.h"
#include "planners/diffusion/training/diffusion_batches.h"

namespace cdiff::planners {

/// The loss of a clean prediction on a batch (the state head gets detached actions), normalized:
///  - `weighted`: mean of w_t (a - a_hat)^2 + mean of (s - s_hat)^2, w_t = 1 + 4 exp(-t / 4), for
///    only the first actions of a plan are executed;
///  - `plain`: mean of (tau^0 - tau^0_hat)^2 over all T x 7 cells, as the paper writes it (III-C3);
/// and the measures by which held-out samples judge a denoiser.
class DiffusionLoss {
 public:
  enum class Kind { kWeighted, kPlain };

  DiffusionLoss(Kind kind, const diffusion::Architecture& architecture,
                const diffusion::Normalizer& normalizer, const at::Device& device);

  /// tau^k = sqrt(alpha_bar_k) tau^0 + sqrt(1 - alpha_bar_k) noise.
  at::Tensor addNoise(const at::Tensor& clean, const at::Tensor& k, const at::Tensor& noise) const;
  /// Its terms `actions` and `states` are the means of the two blocks, weighted as the kind has it.
  learning::Loss loss(const DenoiserNet& denoiser, const TrainingBatch& batch) const;
  /// [states; actions] [B, T, 7] as predicted from tau^k in one step.
  at::Tensor predictClean(const DenoiserNet& denoiser, const at::Tensor& noisy, std::int64_t k,
                          const ContextBatch& context) const;
  /// DDIM from noise over `steps` evenly spaced diffusion steps.
  at::Tensor sample(const DenoiserNet& denoiser, const at::Tensor& noise,
                    const ContextBatch& context, std::int64_t steps) const;
  /// Mean absolute errors of a normalized prediction: ade_m, fde_m, speed_mps, heading_rad,
  /// throttle, steer, brake; keys get `prefix`.
  void addMeasures(const std::string& prefix, const at::Tensor& predicted, const at::Tensor& clean,
                   learning::Measures& measures) const;
  /// One-step predictions at K/2 and K and DDIM samples of held-out samples, the latter also with
  /// the features of a gray image and without route.
  learning::Measures judge(const DenoiserNet& denoiser, const TrainingBatch& held_out,
                           const at::Tensor& grey_features) const;
  /// Standard deviation of the clean prediction's error at k = K, [T, 7] normalized.
  traffic::Rollout spread(const DenoiserNet& denoiser, const TrainingBatch& held_out) const;

 private:
  at::Tensor fixedNoise(const at::Tensor& like, const std::string& name) const;

  Kind kind_;
  diffusion::Architecture architecture_;
  diffusion::NoiseSchedule schedule_;
  at::Device device_;
  at::Tensor signal_;   ///< sqrt(alpha_bar) [K + 1]
  at::Tensor noise_;    ///< sqrt(1 - alpha_bar) [K + 1]
  at::Tensor weights_;  ///< of the rows [1, T, 1]
  at::Tensor scale_;    ///< [T, 7]
};

}  // namespace cdiff::planners
