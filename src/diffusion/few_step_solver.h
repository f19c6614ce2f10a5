// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "diffusion/noise_schedule.h"
#include "diffusion/sampling_batch.h"

namespace cdiff::diffusion {

/// From one visited diffusion step to the next in few-step sampling: tau^m of tau^k and the clean
/// prediction x at k, m < k, after guidance has moved x; the probability-flow ODE, no noise.
/// Normalized. One per run: a multistep solver remembers the steps before.
class FewStepSolver {
 public:
  virtual ~FewStepSolver() = default;
  /// Overwrites the batch's noisy trajectories; `from` > `to` >= 1.
  virtual void step(int from, int to, SamplingBatch& batch) = 0;
};

/// Names of the solvers: "ddim" and "dpmpp_2m".
///  - ddim: first order; the noise that x implies is kept.
///  - dpmpp_2m: DPM-Solver++(2M), second order (arXiv 2211.01095, algorithm 2). With signal a,
///    noise s, lambda = log(a / s), h = lambda_m - lambda_k and x', h' of the visited step before:
///    D = x + h / (2 h') (x - x'), D = x at the first; tau^m = s_m / s_k tau^k - a_m (e^-h - 1) D.
std::vector<std::string> fewStepSolverNames();

/// As its authors write it ("DPM-Solver++(2M)"). Throws std::invalid_argument for an unknown name.
std::string fewStepSolverTitle(const std::string& name);

/// `schedule` must outlive it. Throws std::invalid_argument for an unknown name.
std::unique_ptr<FewStepSolver> makeFewStepSolver(const std::string& name,
                                                 const NoiseSchedule& schedule);

}  // namespace cdiff::diffusion
