// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <vector>

#include "diffusion/network/cpu_denoiser.h"
#include "diffusion/reference_denoiser.h"

namespace cdiff::diffusion {
namespace {

constexpr int kStep = 40;
constexpr std::size_t kSamples = 3;

/// The same random model with routes, without, and mixed.
class RouteScale : public testing::Test {
 protected:
  struct Results {
    std::vector<float> actions, noisy_gradient, states;
  };

  RouteScale() {
    for (std::uint32_t b = 0; b < kSamples; ++b)
      contexts_.push_back(randomContext(model_.architecture, b, true));
  }
  Results resultsOf(Denoiser& denoiser) const {
    const std::size_t rows = kSamples * static_cast<std::size_t>(model_.architecture.horizon);
    const auto values = [&](std::size_t columns, std::uint32_t stream) {
      return randomValues(static_cast<std::int64_t>(rows * columns), stream);
    };
    Results results{std::vector<float>(rows * 3), std::vector<float>(rows * 7),
                    std::vector<float>(rows * 4)};
    denoiser.predictActions(values(7, 1).data(), kStep, results.actions.data());
    denoiser.backwardActions(values(3, 2).data(), results.noisy_gradient.data());
    denoiser.predictStates(values(3, 3).data(), kStep, results.states.data());
    return results;
  }
  Results alone(bool with_route) const {
    std::vector<Context> contexts = contexts_;
    if (!with_route) {
      for (Context& context : contexts) {  // with a route alone: as in training
        context.route.clear();
        context.previous.clear();
        context.target_speed.reset();
      }
    }
    CpuDenoiser denoiser(model_);
    denoiser.setContexts(contexts);
    return resultsOf(denoiser);
  }
  Results mixed(double scale) const {
    CpuDenoiser with(model_);
    CpuDenoiser without(model_);
    RouteScaledDenoiser denoiser(with, without, scale);
    denoiser.setContexts(contexts_);
    return resultsOf(denoiser);
  }

  Model model_ = randomModel(Architecture());
  std::vector<Context> contexts_;
};

/// x_u + w (x_c - x_u) in float, of values below 100: within a few units of 100 x 2^-24.
void expectMix(const std::vector<float>& found, const std::vector<float>& without,
               const std::vector<float>& with, double scale) {
  ASSERT_EQ(found.size(), with.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    const double u = without[i];
    const double c = with[i];
    ASSERT_LT(std::abs(u) + std::abs(c), 100.0);
    ASSERT_NEAR(found[i], u + scale * (c - u), 5e-5) << i;
  }
}

TEST_F(RouteScale, MixesBothPredictionsAndTheirGradients) {
  const Results with = alone(true);
  const Results without = alone(false);
  ASSERT_NE(with.actions, without.actions);
  for (const double scale : {0.0, 0.4, 1.0, 1.2}) {
    SCOPED_TRACE(scale);
    const Results found = mixed(scale);
    expectMix(found.actions, without.actions, with.actions, scale);
    expectMix(found.noisy_gradient, without.noisy_gradient, with.noisy_gradient, scale);
    EXPECT_EQ(found.states, with.states);
    EXPECT_EQ(found.states, without.states);  // states of given actions know no route
  }
  EXPECT_EQ(mixed(0.0).actions, without.actions);
}

/// Training never shows the image before, or a target speed, without a route.
TEST_F(RouteScale, WithoutItsRouteASampleHasNoMotionEither) {
  model_ = randomModel(Architecture().withMotion());
  contexts_.clear();
  for (std::uint32_t b = 0; b < kSamples; ++b) {
    contexts_.push_back(randomContext(model_.architecture, b, true));
    contexts_.back().previous = randomValues(model_.architecture.image_features, b + 3000);
    contexts_.back().target_speed = 7.0 + b;
  }
  ASSERT_NE(alone(true).actions, alone(false).actions);
  EXPECT_EQ(mixed(0.0).actions, alone(false).actions);
}

}  // namespace
}  // namespace cdiff::diffusion
