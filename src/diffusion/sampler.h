// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "diffusion/denoiser.h"
#include "diffusion/noise_schedule.h"
#include "diffusion/normalizer.h"
#include "e2e_cdiff/core/options.h"
#include "e2e_cdiff/core/random.h"

namespace cdiff::diffusion {

/// How trajectories are sampled: mode, solver, number of steps, proximal step and warm start
/// (counts without unit).
struct SamplerOptions {
  std::string mode = "real_time";   ///< paper | real_time | unguided
  std::string solver = "dpmpp_2m";  ///< of mode `real_time`: ddim | dpmpp_2m
  std::int64_t steps = 10;          ///< evenly spaced steps of mode `real_time`
  /// real_time: steps after them, each at half of the one before; these two where that can be
  /// halved
  std::int64_t clean_up_steps = 2;
  std::int64_t inner_iterations = 4;  ///< iterations of the proximal step
  double trust_region = 2.0;          ///< c; a matter of guidance, so its options set it
  bool warm_start = false;            ///< real_time: start from the previous plan where it fits
  std::int64_t warm_start_step = 50;  ///< diffusion step k that it is noised to
  std::int64_t warm_steps = 5;        ///< denoising steps from there
  /// rho: correlation of a vehicle's noise between any two of its decisions, 0 to 1; a matter of
  /// guidance, too
  double noise_correlation = 0.0;

  void describe(core::OptionsVisitor& visitor);
  /// Throws InputError; `diffusion_steps` is K of the model.
  void validate(int diffusion_steps) const;
  /// Diffusion steps that the mode visits, in order, for a cold or a warm start.
  std::vector<int> visitedSteps(int diffusion_steps, bool warm) const;
};

/// J of one sample of the batch on clean normalized trajectories.
class CleanObjective {
 public:
  virtual ~CleanObjective() = default;
  /// Whether anything acts on this sample at this diffusion step.
  virtual bool actsAt(std::size_t sample, int k) const = 0;
  /// J and its gradient with respect to the normalized cells (states and actions as independent
  /// variables); `gradient` has the shape of `clean` and is overwritten.
  virtual double evaluate(std::size_t sample, int k, const Trajectory& clean,
                          Trajectory& gradient) = 0;
};

/// One sample to draw.
struct SampleRequest {
  core::RandomKey key;               ///< vehicle and decision of its noise
  std::uint32_t candidate = 0;       ///< index among the samples of that vehicle
  const Trajectory* warm = nullptr;  ///< previous plan, shifted to now; nullptr: cold start
};

/// One sampled trajectory, normalized, and how guidance acted on it.
struct SampledTrajectory {
  Trajectory clean;  ///< [T, 7]
  std::int64_t guided_steps = 0;
  std::int64_t trust_region_hits = 0;  ///< guided steps in which the trust region acted
};

/// Guided sampling of a batch of normalized trajectories (paper III-C4 and III-D).
///  - `paper`: DDPM over all K steps, tau^{k-1} ~ N(mu_theta - beta_k g^k, beta_k I), g^k the
///    gradient of J(tau^0_hat(tau^k, k, c)) with respect to tau^k through network and state branch
///    (paper eq. 8); no noise is added at k = 1.
///  - `real_time`: few steps of a solver (few_step_solver.h) with a proximal step on the clean
///    prediction, x' = argmin J(x) + |x - x_hat|^2 / (2 r_k^2) on the actions, |x' - x_hat| <= c
///    r_k per element, r_k^2 = s^2 (1 - alpha_bar_k) / (alpha_bar_k s^2 + 1 - alpha_bar_k), s =
///    spread given the context.
///  - `unguided`: DDPM over all K steps without J.
/// All noise of a vehicle is sqrt(rho) z + sqrt(1 - rho) z_i, z the same at each decision i and z_i
/// drawn anew: standard normal at each, with correlation rho between any two.
/// One per planner; keeps references.
class Sampler {
 public:
  Sampler(const SamplerOptions& options, const NoiseSchedule& schedule,
          const traffic::Rollout& spread, const core::RandomStream& noise);

  /// Other values of the options that are a matter of guidance, from the next call on.
  void setGuidance(double trust_region, double noise_correlation) {
    options_.trust_region = trust_region;
    options_.noise_correlation = noise_correlation;
  }
  /// Draws all requests as one batch, for the contexts that `denoiser` holds (same order and
  /// count). Cold or warm starts, not both (std::invalid_argument); modes other than real_time
  /// start cold. `objective` may be nullptr.
  std::vector<SampledTrajectory> sample(Denoiser& denoiser, StateBranch& states,
                                        const std::vector<SampleRequest>& requests,
                                        CleanObjective* objective) const;
  /// Diffusion steps that the mode visits, in order, for a cold or a warm start.
  std::vector<int> visitedSteps(bool warm) const {
    return options_.visitedSteps(schedule_.steps(), warm);
  }

 private:
  SamplerOptions options_;
  const NoiseSchedule& schedule_;
  const traffic::Rollout& spread_;
  core::RandomStream noise_;
};

}  // namespace cdiff::diffusion
