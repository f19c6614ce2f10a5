// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "eager_planner.h"

#include <ATen/ATen.h>
#include <ATen/Parallel.h>

#include <cmath>

#include "benchmark.h"
#include "diffusion/noise_schedule.h"
#include "diffusion/sampler.h"
#include "e2e_cdiff/traffic/vehicle.h"
#include "planners/diffusion/training/networks.h"

namespace cdiff::benchmark {
namespace {

template <class Call>
double medianSeconds(int rounds, Call&& call) {
  at::set_num_threads(1);
  call();
  std::vector<double> seconds;
  for (int i = 0; i < rounds; ++i) seconds.push_back(secondsOf(call));
  return median(seconds);
}

/// Both networks, one vehicle.
class EagerPlanner {
 public:
  EagerPlanner() {
    encoder_.parameters().setTrained(false);
    denoiser_.parameters().setTrained(false);
    context_.route = at::full({1, 2 * sizes_.route_points}, 0.1);
    context_.has_route = at::ones({1, 1});
    context_.speed = at::full({1, 1}, 0.5);
  }

  void encode() { context_.features = encoder_.forward(image_); }
  /// tau^{k-1} of tau^k: guided mean and noise.
  at::Tensor paperStep(const at::Tensor& tau, int k) {
    const at::Tensor noisy = tau.detach().set_requires_grad(true);
    const at::Tensor actions = denoiser_.predictActions(noisy, stepOf(k), context_);
    const at::Tensor clean =
        at::cat({denoiser_.predictStates(actions, stepOf(k), context_, false), actions}, 2);
    clean.backward(objective_gradient_);
    const at::Tensor mean = schedule_.cleanWeight(k) * clean.detach() +
                            schedule_.noisyWeight(k) * tau - schedule_.beta(k) * noisy.grad();
    return k > 1 ? mean + std::sqrt(schedule_.beta(k)) * at::randn_like(mean) : mean;
  }
  /// tau^to of tau^k by DDIM after a proximal step.
  at::Tensor realTimeStep(const at::Tensor& tau, int k, int to) {
    const at::Tensor actions = proximal(denoiser_.predictActions(tau, stepOf(k), context_), k);
    const at::Tensor clean =
        at::cat({denoiser_.predictStates(actions, stepOf(k), context_, true), actions}, 2);
    const double now = schedule_.alphaBar(k);
    const double next = schedule_.alphaBar(to);
    const at::Tensor epsilon = (tau - std::sqrt(now) * clean) / std::sqrt(1.0 - now);
    return std::sqrt(next) * clean + std::sqrt(1.0 - next) * epsilon;
  }
  int diffusionSteps() const { return schedule_.steps(); }
  at::Tensor noise() const { return at::randn({1, sizes_.horizon, traffic::kRolloutColumns}); }

 private:
  static at::Tensor stepOf(int k) { return at::full({1}, k, at::kLong); }
  /// As many evaluations as the planner's default of 4 iterations has.
  at::Tensor proximal(const at::Tensor& prediction, int k) {
    at::Tensor actions = prediction;
    for (int i = 0; i <= kInnerIterations; ++i) {
      const at::Tensor leaf = actions.detach().set_requires_grad(true);
      const at::Tensor states = denoiser_.predictStates(leaf, stepOf(k), context_, false);
      at::cat({states, leaf}, 2).backward(objective_gradient_);
      actions = prediction + (leaf.detach() - 0.1 * leaf.grad() - prediction).clamp(-0.5, 0.5);
    }
    return actions.detach();
  }

  static constexpr int kInnerIterations = 4;
  diffusion::Architecture sizes_;
  diffusion::NoiseSchedule schedule_{static_cast<int>(sizes_.diffusion_steps)};
  planners::ImageEncoderNet encoder_{sizes_, 1};
  planners::DenoiserNet denoiser_{sizes_, 1};
  planners::ContextBatch context_;
  at::Tensor image_ = at::full({1, 3, sizes_.image_height, sizes_.image_width}, 0.1);
  at::Tensor objective_gradient_ = at::full({1, sizes_.horizon, traffic::kRolloutColumns}, 0.01);
};

}  // namespace

double eagerEncoderSeconds() {
  EagerPlanner planner;
  return medianSeconds(15, [&] { planner.encode(); });
}

double eagerPaperSeconds() {
  EagerPlanner planner;
  return medianSeconds(5, [&] {
    planner.encode();
    at::Tensor tau = planner.noise();
    for (int k = planner.diffusionSteps(); k >= 1; --k) tau = planner.paperStep(tau, k);
  });
}

double eagerRealTimeSeconds() {
  EagerPlanner planner;
  const diffusion::NoiseSchedule schedule(planner.diffusionSteps());
  const traffic::Rollout spread;
  const diffusion::Sampler sampler({}, schedule, spread, core::RandomStream(1, "benchmark"));
  const std::vector<int> steps = sampler.visitedSteps(false);
  return medianSeconds(15, [&] {
    planner.encode();
    at::Tensor tau = planner.noise();
    for (std::size_t i = 0; i < steps.size(); ++i)
      tau = planner.realTimeStep(tau, steps[i], i + 1 < steps.size() ? steps[i + 1] : 0);
  });
}

}  // namespace cdiff::benchmark
