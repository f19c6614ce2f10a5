// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <vector>

#include "diffusion/sampler.h"

namespace cdiff::diffusion {

/// The working memory of one guided sampling run: noisy and clean trajectories of a batch,
/// normalized, and their gradients.
/// Blocks [B, T, columns], row-major.
class SamplingBatch {
 public:
  SamplingBatch(std::size_t count, Eigen::Index horizon);

  std::size_t count() const { return count_; }
  Eigen::Index horizon() const { return horizon_; }
  std::size_t cells() const {
    return static_cast<std::size_t>(horizon_) * traffic::kRolloutColumns;
  }
  float* noisy(std::size_t sample) { return noisy_.data() + sample * cells(); }
  float* actions(std::size_t sample);
  float* states(std::size_t sample);

  /// Clean prediction of the whole batch: actions by the denoiser, states by the branch.
  void predict(Denoiser& denoiser, StateBranch& branch, int k);
  /// States of the actions as they are now.
  void predictStates(StateBranch& branch, int k);
  /// [states; actions] of a sample.
  Trajectory clean(std::size_t sample) const;

  /// dJ/d(clean) of every sample on which the objective acts, zero for the others; J per sample.
  std::vector<double> evaluate(CleanObjective& objective, int k);
  /// dJ/d(actions) with the part that reaches them through the states; after evaluate().
  const std::vector<float>& actionGradient(StateBranch& branch);
  /// dJ/d(tau^k) through the network; after evaluate().
  const std::vector<float>& noisyGradient(Denoiser& denoiser, StateBranch& branch);

 private:
  std::size_t count_;
  Eigen::Index horizon_;
  std::vector<float> noisy_;            ///< [B, T, 7]
  std::vector<float> actions_;          ///< [B, T, 3]
  std::vector<float> states_;           ///< [B, T, 4]
  std::vector<float> state_gradient_;   ///< [B, T, 4]
  std::vector<float> direct_gradient_;  ///< [B, T, 3], of the objective itself
  std::vector<float> action_gradient_;  ///< [B, T, 3]
  std::vector<float> noisy_gradient_;   ///< [B, T, 7]
};

// The proximal step of guided few-step sampling: actions x of each sample go from the prediction
// x_hat toward argmin J(x) + |x - x_hat|^2 / (2 r_k^2), at most c r_k away per element.

/// Settings of the proximal step of mode `real_time`.
struct ProximalOptions {
  int iterations = 4;
  double trust_region = 2.0;  ///< c
};

/// Gradient descent in u = (x - x_hat) / r with Barzilai-Borwein step lengths; a step that does not
/// lower the sum is halved. Changes the batch's actions and states; returns whether the trust
/// region acted, by sample. `radius` [T, 3] is r_k.
std::vector<bool> proximalStep(const ProximalOptions& options, const std::vector<float>& radius,
                               int k, StateBranch& branch, CleanObjective& objective,
                               SamplingBatch& batch);

}  // namespace cdiff::diffusion
