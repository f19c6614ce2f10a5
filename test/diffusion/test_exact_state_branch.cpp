// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// The states of sampled actions by the dynamics itself: each sample's own, from its own speed.
#include <gtest/gtest.h>

#include "diffusion/denoiser.h"
#include "dynamics/action_rollout.h"

namespace cdiff::diffusion {
namespace {

using traffic::kActionColumns;
using traffic::kRolloutColumns;
using traffic::kStateColumns;

constexpr Eigen::Index kHorizon = 3;

/// Means of 0.01, 0.02 ... 0.21 and scales of 0.5, 0.6 ... 2.5 in row-major order.
Normalizer counting() {
  Normalizer normalizer{traffic::Rollout(kHorizon, kRolloutColumns),
                        traffic::Rollout(kHorizon, kRolloutColumns)};
  for (int i = 0; i < kHorizon * kRolloutColumns; ++i) {
    normalizer.mean.data()[i] = 0.01 * (i + 1);
    normalizer.scale.data()[i] = 0.5 + 0.1 * i;
  }
  return normalizer;
}

/// Two samples of actions (throttle, steer, brake) that differ in every row; of both pedals the
/// executed action keeps one.
const std::vector<double> kActions = {0.60, 0.10, 0.02, 0.70, -0.2, 0.01, 0.55, 0.30, 0.03,
                                      0.65, -0.1, 0.01, 0.02, 0.15, 0.40, 0.75, 0.25, 0.02};
const std::vector<double> kSpeeds = {5.0, 9.0};

class ExactStates : public ::testing::Test {
 protected:
  std::vector<float> normalizedActions() const {
    std::vector<float> values;
    for (std::size_t i = 0; i < kActions.size(); ++i) {
      const Eigen::Index row = static_cast<Eigen::Index>(i) / kActionColumns % kHorizon;
      const int column = kStateColumns + static_cast<int>(i) % kActionColumns;
      values.push_back(static_cast<float>((kActions[i] - normalizer_.mean(row, column)) /
                                          normalizer_.scale(row, column)));
    }
    return values;
  }
  /// What the dynamics makes of a sample's actions.
  traffic::Rollout driven(std::size_t sample, bool executable) const {
    traffic::Rollout rollout = traffic::Rollout::Zero(kHorizon, kRolloutColumns);
    for (Eigen::Index row = 0; row < kHorizon; ++row) {
      for (int c = 0; c < kActionColumns; ++c)
        rollout(row, kStateColumns + c) =
            kActions[(sample * kHorizon + static_cast<std::size_t>(row)) * kActionColumns +
                     static_cast<std::size_t>(c)];
    }
    if (executable) dynamics::makeExecutable(rollout);
    dynamics_.rollOut(kSpeeds[sample], rollout);
    return rollout;
  }

  Normalizer normalizer_ = counting();
  dynamics::ActionRollout dynamics_;
  ExactStateBranch branch_{{}, normalizer_, kSpeeds};
};

TEST_F(ExactStates, AreThoseOfTheExecutedActionsNormalized) {
  std::vector<float> states(2 * kHorizon * kStateColumns);
  branch_.predict(normalizedActions().data(), 1, states.data());
  for (std::size_t sample = 0; sample < 2; ++sample) {
    const traffic::Rollout rollout = driven(sample, true);
    for (Eigen::Index row = 0; row < kHorizon; ++row) {
      for (int c = 0; c < kStateColumns; ++c) {
        const std::size_t place =
            (sample * kHorizon + static_cast<std::size_t>(row)) * kStateColumns +
            static_cast<std::size_t>(c);
        EXPECT_NEAR(states[place],
                    (rollout(row, c) - normalizer_.mean(row, c)) / normalizer_.scale(row, c), 1e-5)
            << sample << " " << row << " " << c;
      }
    }
  }
}

// dJ/d(normalized action) = scale x sum of ds/da dJ/ds, and dJ/ds = dJ/d(normalized state) / scale.
TEST_F(ExactStates, GradientsGoBackThroughTheDynamics) {
  std::vector<float> states(2 * kHorizon * kStateColumns), gradient(states.size());
  for (std::size_t i = 0; i < gradient.size(); ++i)
    gradient[i] = 0.1F * static_cast<float>(i % 5) - 0.15F;
  branch_.predict(normalizedActions().data(), 1, states.data());
  std::vector<float> found(2 * kHorizon * kActionColumns, 99.0F);
  branch_.backward(gradient.data(), found.data());
  for (std::size_t sample = 0; sample < 2; ++sample) {
    traffic::Rollout pulled = traffic::Rollout::Zero(kHorizon, kRolloutColumns);
    for (Eigen::Index row = 0; row < kHorizon; ++row) {
      for (int c = 0; c < kStateColumns; ++c)
        pulled(row, c) =
            static_cast<double>(
                gradient[(sample * kHorizon + static_cast<std::size_t>(row)) * kStateColumns +
                         static_cast<std::size_t>(c)]) /
            normalizer_.scale(row, c);
    }
    dynamics_.backward(kSpeeds[sample], driven(sample, false), pulled);
    for (Eigen::Index row = 0; row < kHorizon; ++row) {
      for (int c = 0; c < kActionColumns; ++c) {
        const int column = kStateColumns + c;
        EXPECT_NEAR(found[(sample * kHorizon + static_cast<std::size_t>(row)) * kActionColumns +
                          static_cast<std::size_t>(c)],
                    pulled(row, column) * normalizer_.scale(row, column), 1e-5)
            << sample << " " << row << " " << c;
      }
    }
  }
}

}  // namespace
}  // namespace cdiff::diffusion
