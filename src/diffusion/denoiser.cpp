// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "diffusion/denoiser.h"

#include <utility>

#include "dynamics/action_rollout.h"

namespace cdiff::diffusion {
namespace {

using traffic::kActionColumns;
using traffic::kRolloutColumns;
using traffic::kStateColumns;

/// Cell (row, column) of sample `sample` in a [B, T, columns] block.
std::size_t cell(std::size_t sample, Eigen::Index horizon, Eigen::Index row, int column,
                 int columns) {
  return (sample * static_cast<std::size_t>(horizon) + static_cast<std::size_t>(row)) *
             static_cast<std::size_t>(columns) +
         static_cast<std::size_t>(column);
}

}  // namespace

void LearnedStateBranch::predict(const float* actions, int k, float* states) {
  denoiser_.predictStates(actions, k, states);
}

void LearnedStateBranch::backward(const float* state_gradient, float* action_gradient) {
  denoiser_.backwardStates(state_gradient, action_gradient);
}

/// `values` of the contexts with their routes become the mix with other_.
void RouteScaledDenoiser::mixInto(float* values) {
  for (std::size_t i = 0; i < other_.size(); ++i)
    values[i] = other_[i] + scale_ * (values[i] - other_[i]);
}

void RouteScaledDenoiser::setContexts(const std::vector<Context>& contexts) {
  with_route_.setContexts(contexts);
  std::vector<Context> without = contexts;
  for (Context& context : without) {
    context.route.clear();
    context.target_speed.reset();
    context.previous.clear();  // as in training, which leaves the image alone
  }
  without_route_.setContexts(without);
  rows_ = contexts.size() * static_cast<std::size_t>(architecture().horizon);
}

void RouteScaledDenoiser::predictActions(const float* noisy, int k, float* actions) {
  other_.resize(rows_ * kActionColumns);
  with_route_.predictActions(noisy, k, actions);
  without_route_.predictActions(noisy, k, other_.data());
  mixInto(actions);
}

void RouteScaledDenoiser::backwardActions(const float* action_gradient, float* noisy_gradient) {
  other_.resize(rows_ * kRolloutColumns);
  with_route_.backwardActions(action_gradient, noisy_gradient);
  without_route_.backwardActions(action_gradient, other_.data());
  mixInto(noisy_gradient);
}

void RouteScaledDenoiser::predictStates(const float* actions, int k, float* states) {
  with_route_.predictStates(actions, k, states);
}

void RouteScaledDenoiser::backwardStates(const float* state_gradient, float* action_gradient) {
  with_route_.backwardStates(state_gradient, action_gradient);
}

ExactStateBranch::ExactStateBranch(const dynamics::BicycleModelOptions& vehicle,
                                   const Normalizer& normalizer, std::vector<double> speeds,
                                   dynamics::ThrottleResponse response)
    : rollout_(vehicle, response), normalizer_(normalizer), speeds_(std::move(speeds)) {
  last_.assign(speeds_.size(), traffic::Rollout::Zero(normalizer.mean.rows(), kRolloutColumns));
}

void ExactStateBranch::predict(const float* actions, int, float* states) {
  const Eigen::Index horizon = normalizer_.mean.rows();
  for (std::size_t b = 0; b < speeds_.size(); ++b) {
    traffic::Rollout& rollout = last_[b];
    for (Eigen::Index t = 0; t < horizon; ++t) {
      for (int c = 0; c < kActionColumns; ++c) {
        const int column = kStateColumns + c;
        rollout(t, column) = static_cast<double>(actions[cell(b, horizon, t, c, kActionColumns)]) *
                                 normalizer_.scale(t, column) +
                             normalizer_.mean(t, column);
      }
    }
    rollout_.rollOut(speeds_[b], rollout);
    traffic::Rollout executed = rollout;
    dynamics::makeExecutable(executed);
    rollout_.rollOut(speeds_[b], executed);
    for (Eigen::Index t = 0; t < horizon; ++t) {
      for (int c = 0; c < kStateColumns; ++c) {
        states[cell(b, horizon, t, c, kStateColumns)] =
            static_cast<float>((executed(t, c) - normalizer_.mean(t, c)) / normalizer_.scale(t, c));
      }
    }
  }
}

void ExactStateBranch::backward(const float* state_gradient, float* action_gradient) {
  const Eigen::Index horizon = normalizer_.mean.rows();
  for (std::size_t b = 0; b < speeds_.size(); ++b) {
    traffic::Rollout gradient = traffic::Rollout::Zero(horizon, kRolloutColumns);
    for (Eigen::Index t = 0; t < horizon; ++t) {
      for (int c = 0; c < kStateColumns; ++c) {
        gradient(t, c) =
            static_cast<double>(state_gradient[cell(b, horizon, t, c, kStateColumns)]) /
            normalizer_.scale(t, c);
      }
    }
    rollout_.backward(speeds_[b], last_[b], gradient);
    for (Eigen::Index t = 0; t < horizon; ++t) {
      for (int c = 0; c < kActionColumns; ++c) {
        const int column = kStateColumns + c;
        action_gradient[cell(b, horizon, t, c, kActionColumns)] =
            static_cast<float>(gradient(t, column) * normalizer_.scale(t, column));
      }
    }
  }
}

}  // namespace cdiff::diffusion
