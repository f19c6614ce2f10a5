// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "eager_planner.h"

#include <ATen/ATen.h>
#include <ATen/Parallel.h>

#include "benchmark.h"
#include "e2e_cdiff/traffic/rollout.h"
#include "networks.h"

namespace cdiff::benchmark {
namespace {

constexpr int kRounds = 15;

template <class Call>
double medianSeconds(Call&& call) {
  at::set_num_threads(1);
  call();
  std::vector<double> seconds;
  for (int i = 0; i < kRounds; ++i) seconds.push_back(secondsOf(call));
  return median(seconds);
}

}  // namespace

double eagerEncoderSeconds() {
  const diffusion::Architecture sizes;
  training::ImageEncoderNet net(sizes, 1);
  net.parameters().setTrained(false);
  const at::Tensor image = at::full({1, 3, sizes.image_height, sizes.image_width}, 0.1);
  return medianSeconds([&] { net.forward(image); });
}

double eagerGuidedStepSeconds() {
  const diffusion::Architecture sizes;
  training::DenoiserNet net(sizes, 1);
  net.parameters().setTrained(false);
  training::ContextBatch context;
  context.features = at::full({1, sizes.image_features}, 0.1);
  context.route = at::full({1, 2 * sizes.route_points}, 0.1);
  context.has_route = at::ones({1, 1});
  context.speed = at::full({1, 1}, 0.5);
  const at::Tensor k = at::full({1}, 50, at::kLong);
  const at::Tensor gradient = at::ones({1, sizes.horizon, traffic::kActionColumns});
  return medianSeconds([&] {
    at::Tensor noisy =
        at::full({1, sizes.horizon, traffic::kRolloutColumns}, 0.1).set_requires_grad(true);
    net.predictActions(noisy, k, context).backward(gradient);
  });
}

}  // namespace cdiff::benchmark
