// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "diffusion/sampling_batch.h"

namespace cdiff::diffusion {
namespace {

using traffic::kActionColumns;
using traffic::kRolloutColumns;
using traffic::kStateColumns;

using ActionBlock = Eigen::Matrix<float, Eigen::Dynamic, kActionColumns, Eigen::RowMajor>;
using StateBlock = Eigen::Matrix<float, Eigen::Dynamic, kStateColumns, Eigen::RowMajor>;

}  // namespace

SamplingBatch::SamplingBatch(std::size_t count, Eigen::Index horizon)
    : count_(count), horizon_(horizon) {
  const std::size_t rows = count * static_cast<std::size_t>(horizon);
  noisy_.assign(rows * kRolloutColumns, 0.0F);
  actions_.assign(rows * kActionColumns, 0.0F);
  states_.assign(rows * kStateColumns, 0.0F);
  state_gradient_ = states_;
  direct_gradient_ = actions_;
  action_gradient_ = actions_;
  noisy_gradient_ = noisy_;
}

float* SamplingBatch::actions(std::size_t sample) {
  return actions_.data() + sample * static_cast<std::size_t>(horizon_) * kActionColumns;
}

float* SamplingBatch::states(std::size_t sample) {
  return states_.data() + sample * static_cast<std::size_t>(horizon_) * kStateColumns;
}

void SamplingBatch::predict(Denoiser& denoiser, StateBranch& branch, int k) {
  denoiser.predictActions(noisy_.data(), k, actions_.data());
  predictStates(branch, k);
}

void SamplingBatch::predictStates(StateBranch& branch, int k) {
  branch.predict(actions_.data(), k, states_.data());
}

Trajectory SamplingBatch::clean(std::size_t sample) const {
  const std::size_t row = sample * static_cast<std::size_t>(horizon_);
  Trajectory trajectory(horizon_, kRolloutColumns);
  trajectory.leftCols<kStateColumns>() =
      Eigen::Map<const StateBlock>(states_.data() + row * kStateColumns, horizon_, kStateColumns);
  trajectory.rightCols<kActionColumns>() = Eigen::Map<const ActionBlock>(
      actions_.data() + row * kActionColumns, horizon_, kActionColumns);
  return trajectory;
}

std::vector<double> SamplingBatch::evaluate(CleanObjective& objective, int k) {
  std::vector<double> values(count_, 0.0);
  Trajectory gradient(horizon_, kRolloutColumns);
  for (std::size_t b = 0; b < count_; ++b) {
    gradient.setZero(horizon_, kRolloutColumns);
    if (objective.actsAt(b, k)) values[b] = objective.evaluate(b, k, clean(b), gradient);
    const std::size_t row = b * static_cast<std::size_t>(horizon_);
    Eigen::Map<StateBlock>(state_gradient_.data() + row * kStateColumns, horizon_, kStateColumns) =
        gradient.leftCols<kStateColumns>();
    Eigen::Map<ActionBlock>(direct_gradient_.data() + row * kActionColumns, horizon_,
                            kActionColumns) = gradient.rightCols<kActionColumns>();
  }
  return values;
}

const std::vector<float>& SamplingBatch::actionGradient(StateBranch& branch) {
  branch.pullBack(state_gradient_.data(), action_gradient_.data());
  for (std::size_t i = 0; i < action_gradient_.size(); ++i)
    action_gradient_[i] += direct_gradient_[i];
  return action_gradient_;
}

const std::vector<float>& SamplingBatch::noisyGradient(Denoiser& denoiser, StateBranch& branch) {
  denoiser.pullBackActions(actionGradient(branch).data(), noisy_gradient_.data());
  return noisy_gradient_;
}

}  // namespace cdiff::diffusion
