// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "diffusion/sampling_batch.h"

#include <algorithm>
#include <cmath>

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
  branch.backward(state_gradient_.data(), action_gradient_.data());
  for (std::size_t i = 0; i < action_gradient_.size(); ++i)
    action_gradient_[i] += direct_gradient_[i];
  return action_gradient_;
}

const std::vector<float>& SamplingBatch::noisyGradient(Denoiser& denoiser, StateBranch& branch) {
  denoiser.backwardActions(actionGradient(branch).data(), noisy_gradient_.data());
  return noisy_gradient_;
}

namespace {

/// Descent of one sample, in u.
struct Descent {
  std::vector<float> center;  ///< x_hat
  std::vector<double> u;      ///< best so far
  std::vector<double> slope;  ///< gradient at u
  double value = 0.0;         ///< J + |u|^2 / 2 at u
  std::vector<double> trial;  ///< being evaluated
  double length = 0.0;        ///< of the step that led to `trial`
  bool clipped = false;
};

double halfSquare(const std::vector<double>& u) {
  double sum = 0.0;
  for (const double value : u) sum += value * value;
  return 0.5 * sum;
}

double largest(const std::vector<double>& values) {
  double most = 0.0;
  for (const double value : values) most = std::max(most, std::abs(value));
  return most;
}

/// dJ/du + u.
std::vector<double> slopeAt(const std::vector<double>& u, const float* action_gradient,
                            const std::vector<float>& radius) {
  std::vector<double> slope(u.size());
  for (std::size_t i = 0; i < u.size(); ++i)
    slope[i] = static_cast<double>(action_gradient[i]) * static_cast<double>(radius[i]) + u[i];
  return slope;
}

void propose(Descent& descent, double trust_region) {
  descent.trial.resize(descent.u.size());
  for (std::size_t i = 0; i < descent.u.size(); ++i) {
    const double free = descent.u[i] - descent.length * descent.slope[i];
    descent.trial[i] = std::clamp(free, -trust_region, trust_region);
    descent.clipped = descent.clipped || descent.trial[i] != free;
  }
}

/// Barzilai-Borwein: |du|^2 / (du . dslope); at least one (the curvature of the prior alone) where
/// the sum is not convex.
double nextLength(const std::vector<double>& du, const std::vector<double>& dslope) {
  double square = 0.0;
  double product = 0.0;
  for (std::size_t i = 0; i < du.size(); ++i) {
    square += du[i] * du[i];
    product += du[i] * dslope[i];
  }
  return product > 1e-12 ? std::min(1.0, square / product) : 1.0;
}

/// Takes the trial over when it is better, else halves the step.
void judge(Descent& descent, double value, const std::vector<double>& slope) {
  if (!std::isfinite(value) || value > descent.value) {
    descent.length *= 0.5;
    return;
  }
  std::vector<double> du(slope.size());
  std::vector<double> dslope(slope.size());
  for (std::size_t i = 0; i < slope.size(); ++i) {
    du[i] = descent.trial[i] - descent.u[i];
    dslope[i] = slope[i] - descent.slope[i];
  }
  descent.length = nextLength(du, dslope);
  descent.u = descent.trial;
  descent.slope = slope;
  descent.value = value;
}

void place(const Descent& descent, const std::vector<double>& u, const std::vector<float>& radius,
           float* actions) {
  for (std::size_t i = 0; i < u.size(); ++i)
    actions[i] = descent.center[i] + radius[i] * static_cast<float>(u[i]);
}

/// Descents at x_hat, with the first step reaching half of the trust region at most.
std::vector<Descent> startDescents(const ProximalOptions& options, const std::vector<float>& radius,
                                   int k, StateBranch& branch, CleanObjective& objective,
                                   SamplingBatch& batch) {
  const std::vector<double> values = batch.evaluate(objective, k);
  const std::vector<float>& gradient = batch.actionGradient(branch);
  std::vector<Descent> descents(batch.count());
  for (std::size_t b = 0; b < batch.count(); ++b) {
    Descent& descent = descents[b];
    descent.center.assign(batch.actions(b), batch.actions(b) + radius.size());
    descent.u.assign(radius.size(), 0.0);
    descent.slope = slopeAt(descent.u, gradient.data() + b * radius.size(), radius);
    descent.value = values[b];
    const double steepest = largest(descent.slope);
    descent.length = steepest > 0.0 ? std::min(1.0, 0.5 * options.trust_region / steepest) : 0.0;
  }
  return descents;
}

}  // namespace

std::vector<bool> proximalStep(const ProximalOptions& options, const std::vector<float>& radius,
                               int k, StateBranch& branch, CleanObjective& objective,
                               SamplingBatch& batch) {
  std::vector<Descent> descents = startDescents(options, radius, k, branch, objective, batch);
  for (int iteration = 0; iteration < options.iterations; ++iteration) {
    for (std::size_t b = 0; b < batch.count(); ++b) {
      propose(descents[b], options.trust_region);
      place(descents[b], descents[b].trial, radius, batch.actions(b));
    }
    batch.predictStates(branch, k);
    const std::vector<double> values = batch.evaluate(objective, k);
    const std::vector<float>& gradient = batch.actionGradient(branch);
    for (std::size_t b = 0; b < batch.count(); ++b) {
      Descent& descent = descents[b];
      judge(descent, values[b] + halfSquare(descent.trial),
            slopeAt(descent.trial, gradient.data() + b * radius.size(), radius));
    }
  }
  std::vector<bool> clipped(batch.count());
  for (std::size_t b = 0; b < batch.count(); ++b) {
    place(descents[b], descents[b].u, radius, batch.actions(b));
    clipped[b] = descents[b].clipped;
  }
  batch.predictStates(branch, k);
  return clipped;
}

}  // namespace cdiff::diffusion
