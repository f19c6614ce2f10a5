// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// A problem with a known answer: every action cell has the prior N(0, s^2), the exact denoiser of
/// it, no states; the objective is J = w (x - 1)^2 per cell.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "diffusion/sampler.h"

namespace cdiff::diffusion::test {

inline constexpr int kHorizon = 4;

inline Architecture smallArchitecture() {
  Architecture architecture;
  architecture.horizon = kHorizon;
  return architecture;
}

/// E[x | tau] = s^2 sqrt(ab) / (ab s^2 + 1 - ab) tau.
class GaussianDenoiser : public Denoiser {
 public:
  GaussianDenoiser(const NoiseSchedule& schedule, double s) : schedule_(schedule), s_(s) {}
  const Architecture& architecture() const override { return architecture_; }
  void setContexts(const std::vector<Context>& contexts) override { count_ = contexts.size(); }
  void predictActions(const float* noisy, int k, float* actions) override {
    gain_ = gain(k);
    for (std::size_t row = 0; row < count_ * kHorizon; ++row) {
      for (std::size_t c = 0; c < 3; ++c) actions[row * 3 + c] = gain_ * noisy[row * 7 + 4 + c];
    }
  }
  void backwardActions(const float* action_gradient, float* noisy_gradient) override {
    std::fill(noisy_gradient, noisy_gradient + count_ * kHorizon * 7, 0.0F);
    for (std::size_t row = 0; row < count_ * kHorizon; ++row) {
      for (std::size_t c = 0; c < 3; ++c)
        noisy_gradient[row * 7 + 4 + c] = gain_ * action_gradient[row * 3 + c];
    }
  }
  void predictStates(const float*, int, float* states) override {
    std::fill(states, states + count_ * kHorizon * 4, 0.0F);
  }
  void backwardStates(const float*, float* action_gradient) override {
    std::fill(action_gradient, action_gradient + count_ * kHorizon * 3, 0.0F);
  }

 private:
  float gain(int k) const {
    const double ab = schedule_.alphaBar(k);
    return static_cast<float>(s_ * s_ * std::sqrt(ab) / (ab * s_ * s_ + 1.0 - ab));
  }
  const NoiseSchedule& schedule_;
  double s_;
  Architecture architecture_ = smallArchitecture();
  std::size_t count_ = 0;
  float gain_ = 0.0F;
};

/// J = w sum (x - 1)^2 over the action cells.
class TargetOne : public CleanObjective {
 public:
  explicit TargetOne(double weight) : weight_(weight) {}
  bool actsAt(std::size_t, int) const override { return weight_ > 0.0; }
  double evaluate(std::size_t, int, const Trajectory& clean, Trajectory& gradient) override {
    double value = 0.0;
    gradient.setZero();
    for (Eigen::Index t = 0; t < clean.rows(); ++t) {
      for (Eigen::Index c = 4; c < 7; ++c) {
        value += weight_ * std::pow(clean(t, c) - 1.0, 2);
        gradient(t, c) = static_cast<float>(2.0 * weight_ * (clean(t, c) - 1.0));
      }
    }
    return value;
  }

 private:
  double weight_;
};

/// Mean and standard deviation of all sampled action cells.
struct Moments {
  double mean = 0.0;
  double deviation = 0.0;
};

/// A plan of the prior for each run: what unguided sampling left behind.
inline std::vector<Trajectory> priorPlans(double s, std::uint32_t runs) {
  const core::RandomStream random(9, "previous plans");
  std::vector<Trajectory> plans(runs, Trajectory::Zero(kHorizon, 7));
  for (std::uint32_t i = 0; i < runs; ++i) {
    for (Eigen::Index cell = 0; cell < plans[i].size(); ++cell) {
      plans[i].data()[cell] =
          static_cast<float>(s * random.normal({1, i, 0}, static_cast<std::uint32_t>(cell)));
    }
  }
  return plans;
}

/// Of `runs` x 12 cells; warm starts from `previous` where it is not empty.
inline Moments sampleMoments(const SamplerOptions& options, double s, double weight,
                             std::uint32_t runs, const std::vector<Trajectory>& previous = {}) {
  const NoiseSchedule schedule(100);
  const traffic::Rollout spread = traffic::Rollout::Constant(kHorizon, 7, s);
  const Sampler sampler(options, schedule, spread, core::RandomStream(7, "noise"));
  GaussianDenoiser denoiser(schedule, s);
  LearnedStateBranch branch(denoiser);
  TargetOne objective(weight);
  std::vector<SampleRequest> requests(runs);
  for (std::uint32_t i = 0; i < runs; ++i) {
    requests[i].key = {1, i, 0};
    if (!previous.empty()) requests[i].warm = &previous[i];
  }
  denoiser.setContexts(std::vector<Context>(runs));
  double sum = 0.0;
  double square = 0.0;
  for (const SampledTrajectory& sample : sampler.sample(denoiser, branch, requests, &objective)) {
    const Eigen::ArrayXXd cells = sample.clean.rightCols<3>().cast<double>().array();
    sum += cells.sum();
    square += cells.square().sum();
  }
  const double count = runs * kHorizon * 3.0;
  return {sum / count, std::sqrt(square / count - std::pow(sum / count, 2))};
}

}  // namespace cdiff::diffusion::test
