// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// What trains and what drives are two implementations of docs/neural_network.md: with the same
// weights they must give the same measures. Tolerances: float32 sums of up to 4,608 products in
// another order.
#include <gtest/gtest.h>

#include "diffusion/network/cpu_denoiser.h"
#include "diffusion/network/image_encoder.h"
#include "planners/diffusion/training/networks.h"
#include "support/random_model.h"

namespace cdiff::planners {
namespace {

using learning::toTensor;
using learning::toVector;
using test::relativeDifference;

using diffusion::Architecture;
using diffusion::Model;

constexpr std::int64_t kBatch = 3;

std::vector<float> draws(std::size_t count, const char* name) {
  const core::RandomStream random(3, name);
  std::vector<float> values;
  for (std::size_t i = 0; i < count; ++i)
    values.push_back(static_cast<float>(random.normal({}, static_cast<std::uint32_t>(i))));
  return values;
}

/// Every set of inputs that a network may take.
class Inference : public ::testing::TestWithParam<const char*> {
 protected:
  static Architecture sizesOf(const std::string& inputs) {
    if (inputs == "paper") return Architecture().imageAlone();
    if (inputs == "pinned") return Architecture().pinned();
    return inputs == "motion" ? Architecture().withMotion() : Architecture();
  }

  Inference()
      : sizes_(sizesOf(GetParam())),
        model_(cdiff::testing::randomModel(sizes_)),
        net_(sizes_, 1),
        ours_(model_) {
    net_.parameters().load(model_.denoiser, "random");
    net_.parameters().setTrained(false);
    const auto b = static_cast<std::size_t>(kBatch);
    const std::vector<float> features = draws(b * 256, "features");
    const std::vector<float> route = draws(b * 32, "route");
    std::vector<diffusion::Context> contexts(b);
    for (std::size_t i = 0; i < b; ++i) {
      contexts[i].image_features.assign(features.begin() + static_cast<long>(i * 256),
                                        features.begin() + static_cast<long>(i * 256 + 256));
      // The last one has no route.
      if (i + 1 < b && sizes_.takesRoute())
        contexts[i].route.assign(route.begin() + static_cast<long>(i * 32),
                                 route.begin() + static_cast<long>(i * 32 + 32));
      contexts[i].speed = 2.0 + 3.0 * static_cast<double>(i);
    }
    if (sizes_.takesPrevious()) addMotion(contexts);
    ours_.setContexts(contexts);
    context_.features = toTensor(features, {kBatch, 256}, at::kCPU);
    context_.route = toTensor(route, {kBatch, 32}, at::kCPU);
    context_.has_route = toTensor({1.0F, 1.0F, 0.0F}, {kBatch, 1}, at::kCPU);
    context_.speed = toTensor({0.2F, 0.5F, 0.8F}, {kBatch, 1}, at::kCPU);
  }

  /// The first one has no image before, the second no target speed.
  void addMotion(std::vector<diffusion::Context>& contexts) {
    const std::vector<float> previous = draws(static_cast<std::size_t>(kBatch) * 256, "previous");
    for (std::size_t i = 0; i < contexts.size(); ++i) {
      if (i != 0)
        contexts[i].previous.assign(previous.begin() + static_cast<long>(i * 256),
                                    previous.begin() + static_cast<long>(i * 256 + 256));
      if (i != 1) contexts[i].target_speed = 10.0 - 2.0 * static_cast<double>(i);
    }
    context_.previous = toTensor(previous, {kBatch, 256}, at::kCPU);
    context_.has_previous = toTensor({0.0F, 1.0F, 1.0F}, {kBatch, 1}, at::kCPU);
    context_.target = toTensor({1.0F, 0.0F, 0.6F}, {kBatch, 1}, at::kCPU);
    context_.has_target = toTensor({1.0F, 0.0F, 1.0F}, {kBatch, 1}, at::kCPU);
  }

  at::Tensor steps(std::int64_t k) const { return at::full({kBatch}, k, at::kLong); }

  Architecture sizes_;
  Model model_;
  DenoiserNet net_;
  diffusion::CpuDenoiser ours_;
  ContextBatch context_;
};

TEST_P(Inference, ActionHeadAndItsBackwardPassAgrees) {
  const std::vector<float> noisy = draws(kBatch * 32 * 7, "noisy");
  const std::vector<float> gradient = draws(kBatch * 32 * 3, "gradient");
  for (const int k : {1, 50, 100}) {
    at::Tensor input = toTensor(noisy, {kBatch, 32, 7}, at::kCPU).clone().set_requires_grad(true);
    const at::Tensor expected = net_.predictActions(input, steps(k), context_);
    expected.backward(toTensor(gradient, {kBatch, 32, 3}, at::kCPU));
    std::vector<float> actions(gradient.size());
    std::vector<float> pulled(noisy.size());
    ours_.predictActions(noisy.data(), k, actions.data());
    ours_.backwardActions(gradient.data(), pulled.data());
    EXPECT_LT(relativeDifference(actions, toVector(expected.detach())), 1e-5) << k;
    EXPECT_LT(relativeDifference(pulled, toVector(input.grad())), 1e-4) << k;
  }
}

TEST_P(Inference, StateHeadAndItsBackwardPassAgrees) {
  const std::vector<float> actions = draws(kBatch * 32 * 3, "actions");
  const std::vector<float> gradient = draws(kBatch * 32 * 4, "state gradient");
  at::Tensor input = toTensor(actions, {kBatch, 32, 3}, at::kCPU).clone().set_requires_grad(true);
  const at::Tensor expected = net_.predictStates(input, steps(30), context_, false);
  expected.backward(toTensor(gradient, {kBatch, 32, 4}, at::kCPU));
  std::vector<float> states(gradient.size());
  std::vector<float> pulled(actions.size());
  ours_.predictStates(actions.data(), 30, states.data());
  ours_.backwardStates(gradient.data(), pulled.data());
  EXPECT_LT(relativeDifference(states, toVector(expected.detach())), 1e-5);
  EXPECT_LT(relativeDifference(pulled, toVector(input.grad())), 1e-5);
}

TEST_P(Inference, ImageEncoderAgrees) {
  ImageEncoderNet net(sizes_, 1);
  net.parameters().load(model_.encoder, "random");
  net.parameters().setTrained(false);
  traffic::CameraImage image;
  image.width = 160;
  image.height = 96;
  std::vector<float> planes(3 * 96 * 160);
  for (std::size_t i = 0; i < planes.size(); ++i) {
    const auto value = static_cast<std::uint8_t>((i * 7919 + i / 311 * 13) % 256);
    image.rgb.push_back(value);
    // Pixel-interleaved to planes, scaled as in docs/neural_network.md.
    planes[i % 3 * 96 * 160 + i / 3] = (static_cast<float>(value) / 255.0F - 0.5F) / 0.25F;
  }
  diffusion::ImageEncoder ours(model_);
  const at::Tensor expected = net.forward(toTensor(planes, {1, 3, 96, 160}, at::kCPU));
  EXPECT_LT(relativeDifference(ours.encode(image), toVector(expected)), 1e-4);
}

TEST_P(Inference, WhatIsNoInputIsRefused) {
  const auto refuses = [&](const diffusion::Context& context) {
    try {
      ours_.setContexts({context});
    } catch (const std::invalid_argument&) {
      return true;
    }
    return false;
  };
  diffusion::Context plain;
  plain.image_features.assign(256, 0.0F);
  EXPECT_FALSE(refuses(plain));
  diffusion::Context route = plain;
  route.route.assign(32, 0.0F);
  EXPECT_EQ(refuses(route), !sizes_.takesRoute());
  diffusion::Context previous = plain;
  previous.previous.assign(256, 0.0F);
  EXPECT_EQ(refuses(previous), !sizes_.takesPrevious());
  previous.previous.pop_back();
  EXPECT_TRUE(refuses(previous));
  diffusion::Context target = plain;
  target.target_speed = 8.0;
  EXPECT_EQ(refuses(target), !sizes_.takesTarget());
}

TEST_P(Inference, WithoutItsInputTheSpeedChangesNothing) {
  diffusion::Context context;
  context.image_features = draws(256, "features");
  const std::vector<float> noisy = draws(32 * 7, "noisy");
  std::vector<float> actions[2];
  std::vector<float> states[2];
  for (int i = 0; i < 2; ++i) {
    context.speed = 8.0 * i;
    ours_.setContexts({context});
    actions[i].resize(32 * 3);
    states[i].resize(32 * 4);
    ours_.predictActions(noisy.data(), 40, actions[i].data());
    ours_.predictStates(actions[0].data(), 40, states[i].data());
  }
  EXPECT_EQ(actions[0] == actions[1], !sizes_.startsFromSpeed());
  EXPECT_EQ(states[0] == states[1], !sizes_.startsFromSpeed());
}

// A reverse step, forward and backward, leaves nothing behind: the current state is as it was.
TEST_P(Inference, EveryDiffusionStepStartsFromTheSameCurrentState) {
  const std::vector<float> noisy = draws(kBatch * 32 * 7, "noisy");
  const std::vector<float> gradient = draws(kBatch * 32 * 3, "gradient");
  std::vector<float> first(gradient.size());
  std::vector<float> again(gradient.size());
  std::vector<float> pulled(noisy.size());
  ours_.predictActions(noisy.data(), 40, first.data());
  for (int k = 100; k > 40; k -= 20) {
    const std::vector<float> other = draws(noisy.size(), "other");
    ours_.predictActions(other.data(), k, again.data());
    ours_.backwardActions(gradient.data(), pulled.data());
  }
  ours_.predictActions(noisy.data(), 40, again.data());
  EXPECT_EQ(first, again);
}

INSTANTIATE_TEST_SUITE_P(Inputs, Inference,
                         ::testing::Values("default", "paper", "pinned", "motion"));

}  // namespace
}  // namespace cdiff::planners
