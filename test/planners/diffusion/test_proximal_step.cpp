// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "diffusion/network/cpu_denoiser.h"
#include "diffusion/reference_denoiser.h"
#include "diffusion/sampling_batch.h"
#include "guidance/guidance_world.h"
#include "planners/diffusion/guided_batch.h"
#include "support/random_model.h"

namespace cdiff::diffusion {
namespace {

constexpr int kStep = 3;  // of K = 5
constexpr std::size_t kSamples = 6;
constexpr std::size_t kCells = 3 * test::kRows;
constexpr float kRadius = 0.3F;

/// Acts everywhere and is 0.
class Nothing : public CleanObjective {
 public:
  bool actsAt(std::size_t, int) const override { return true; }
  double evaluate(std::size_t, int, const Trajectory&, Trajectory& gradient) override {
    gradient.setZero();
    return 0.0;
  }
};

/// J = c / 2 |a - goal|^2 over the actions, with c r^2 = 1e4 and the goal at u = 0.01.
class Stiff : public CleanObjective {
 public:
  explicit Stiff(const std::vector<std::vector<float>>& centers) : centers_(centers) {}
  bool actsAt(std::size_t, int) const override { return true; }
  double evaluate(std::size_t sample, int, const Trajectory& clean, Trajectory& gradient) override {
    constexpr double kCurvature = 1e4 / (kRadius * kRadius);
    gradient.setZero();
    double sum = 0.0;
    for (std::size_t i = 0; i < kCells; ++i) {
      const auto row = static_cast<Eigen::Index>(i / 3);
      const auto column = traffic::kRolloutThrottle + static_cast<Eigen::Index>(i % 3);
      const double away = clean(row, column) - centers_[sample][i] - 0.01 * kRadius;
      gradient(row, column) = static_cast<float>(kCurvature * away);
      sum += 0.5 * kCurvature * away * away;
    }
    return sum;
  }

 private:
  const std::vector<std::vector<float>>& centers_;
};

/// A batch of random actions of a random small network near other vehicles and the road's border,
/// all objectives at work.
class ProximalStep : public ::testing::Test {
 protected:
  ProximalStep() {
    world_.scene().state = world_.placed(40.0, 1.2, 0.1, 8.0);
    denoiser_.setContexts(std::vector<Context>(kSamples, randomContext(sizes(), 4)));
  }
  static Architecture sizes() {
    Architecture sizes = smallArchitecture();
    sizes.horizon = test::kRows;
    return sizes;
  }

  /// Weights `weight` for all objectives.
  void guide(double weight) {
    for (auto& entry : options_.objectives) entry.weight = weight;
    for (std::size_t b = 0; b < kSamples; ++b)
      objectives_.push_back(std::make_unique<guidance::TotalObjective>(options_, world_.scene()));
  }
  planners::GuidedBatch guidedBatch() {
    std::vector<guidance::TotalObjective*> pointers;
    for (const auto& objective : objectives_) pointers.push_back(objective.get());
    return {model_.normalizer, pointers};
  }
  /// The clean prediction x_hat and its states.
  void predict(StateBranch& branch) {
    const std::vector<float> actions = randomValues(kSamples * kCells, 3);
    for (std::size_t b = 0; b < kSamples; ++b)
      std::copy_n(actions.begin() + static_cast<std::ptrdiff_t>(b * kCells), kCells,
                  batch_.actions(b));
    batch_.predictStates(branch, kStep);
  }
  std::vector<float> actionsOf(std::size_t sample) {
    return {batch_.actions(sample), batch_.actions(sample) + kCells};
  }

  /// The step on every sample: J + |u|^2 / 2 falls, no |u_i| exceeds the trust region.
  void expectDescent(StateBranch& branch, double trust_region) {
    planners::GuidedBatch guided = guidedBatch();
    predict(branch);
    std::vector<std::vector<float>> before;
    for (std::size_t b = 0; b < kSamples; ++b) before.push_back(actionsOf(b));
    const std::vector<double> start = batch_.evaluate(guided, kStep);
    const auto clipped = proximalStep({4, trust_region}, std::vector<float>(kCells, kRadius), kStep,
                                      branch, guided, batch_);
    const std::vector<double> end = batch_.evaluate(guided, kStep);
    for (std::size_t b = 0; b < kSamples; ++b) {
      double half_square = 0.0;
      double farthest = 0.0;
      for (std::size_t i = 0; i < kCells; ++i) {
        const double u = static_cast<double>(actionsOf(b)[i] - before[b][i]) / kRadius;
        half_square += 0.5 * u * u;
        farthest = std::max(farthest, std::abs(u));
      }
      // Places are float32: actions up to 4 are rounded by 2.4e-7, u by 8e-7, |u|^2 / 2 over 24
      // cells of at most the trust region by 24 x trust_region x 8e-7.
      const double rounding = 24.0 * trust_region * 8e-7;
      EXPECT_LE(end[b] + half_square, start[b] + rounding) << b;
      EXPECT_LT(end[b], start[b]) << b;
      EXPECT_GT(half_square, 0.0) << b;
      EXPECT_LE(farthest, trust_region + 2e-6) << b;
      clipped_ += clipped[b] ? 1 : 0;
    }
  }

  test::GuidanceWorld world_;
  Model model_ = cdiff::testing::randomDenoiser(sizes());
  CpuDenoiser denoiser_{model_};
  guidance::GuidanceOptions options_;
  std::vector<std::unique_ptr<guidance::TotalObjective>> objectives_;
  SamplingBatch batch_{kSamples, test::kRows};
  int clipped_ = 0;
};

TEST_F(ProximalStep, LowersTheSumWithinTheTrustRegion) {
  LearnedStateBranch branch(denoiser_);
  guide(1.0);
  expectDescent(branch, 2.0);
}

TEST_F(ProximalStep, NarrowTrustRegionActs) {
  LearnedStateBranch branch(denoiser_);
  guide(5.0);
  expectDescent(branch, 0.1);
  EXPECT_EQ(clipped_, static_cast<int>(kSamples));
}

TEST_F(ProximalStep, WideTrustRegionDoesNotAct) {
  LearnedStateBranch branch(denoiser_);
  guide(0.001);
  expectDescent(branch, 50.0);
  EXPECT_EQ(clipped_, 0);
}

TEST_F(ProximalStep, LowersTheSumThroughTheDynamics) {
  ExactStateBranch branch({}, model_.normalizer, std::vector<double>(kSamples, 8.0));
  guide(0.2);
  expectDescent(branch, 2.0);
}

// The first step reaches half of the trust region, u = 0.05 in every cell: J rises from 24 x 5000 x
// 0.01^2 = 12 to 24 x 5000 x 0.04^2 = 192, so nothing is taken. Half of it, 0.025, gives 27:
// nothing either. 0.0125 gives 0.75.
TEST_F(ProximalStep, TakesNoStepThatOvershoots) {
  LearnedStateBranch branch(denoiser_);
  for (const auto& [iterations, most] : {std::pair{1, 12.0}, {2, 12.0}, {3, 0.76}}) {
    predict(branch);
    std::vector<std::vector<float>> centers;
    for (std::size_t b = 0; b < kSamples; ++b) centers.push_back(actionsOf(b));
    Stiff stiff(centers);
    proximalStep({iterations, 0.1}, std::vector<float>(kCells, kRadius), kStep, branch, stiff,
                 batch_);
    const std::vector<double> end = batch_.evaluate(stiff, kStep);
    for (std::size_t b = 0; b < kSamples; ++b) {
      EXPECT_EQ(actionsOf(b) == centers[b], iterations < 3) << b;
      EXPECT_NEAR(end[b], most, 0.05) << b;
    }
  }
}

TEST_F(ProximalStep, WhereNothingPullsEveryBitStays) {
  LearnedStateBranch branch(denoiser_);
  predict(branch);
  std::vector<Trajectory> before;
  for (std::size_t b = 0; b < kSamples; ++b) before.push_back(batch_.clean(b));
  Nothing nothing;
  const auto clipped =
      proximalStep({4, 2.0}, std::vector<float>(kCells, kRadius), kStep, branch, nothing, batch_);
  for (std::size_t b = 0; b < kSamples; ++b) {
    const Trajectory after = batch_.clean(b);
    const auto bytes = sizeof(float) * static_cast<std::size_t>(after.size());
    EXPECT_EQ(std::memcmp(after.data(), before[b].data(), bytes), 0) << b;
    EXPECT_FALSE(clipped[b]);
  }
}

}  // namespace
}  // namespace cdiff::diffusion
