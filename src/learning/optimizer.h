// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <ATen/ATen.h>

#include <vector>

namespace cdiff::learning {

/// Weight decay, and the decay per step of the moving average of the weights.
struct OptimizerOptions {
  double weight_decay = 1e-4;
  double average_decay = 0.999;
};

/// AdamW with a moving average of the weights: m = b1 m + (1-b1) g, v = b2 v + (1-b2) g^2,
/// w -= r (m' / (sqrt(v') + 1e-8) + decay w), m', v' corrected for their start; average += (1-d)
/// (w - average), d = min(average_decay, (1+n)/(10+n)). Decay acts on tensors of two dimensions and
/// more.
class Optimizer {
 public:
  Optimizer(std::vector<at::Tensor> parameters, const OptimizerOptions& options);

  void clearGradients();
  /// Scales the gradients down to the norm `limit`; returns their norm before.
  double clipGradients(double limit);
  /// Step `n` = 0, 1, ...
  void step(std::int64_t n, double rate);
  /// Exchanges weights and their average.
  void swapAverage();
  bool parametersFinite() const;

  std::vector<at::Tensor>& firstMoments() { return first_; }
  std::vector<at::Tensor>& secondMoments() { return second_; }
  std::vector<at::Tensor>& averages() { return average_; }
  std::vector<at::Tensor>& parameters() { return parameters_; }

 private:
  OptimizerOptions options_;
  std::vector<at::Tensor> parameters_;
  std::vector<at::Tensor> first_;
  std::vector<at::Tensor> second_;
  std::vector<at::Tensor> average_;
};

}  // namespace cdiff::learning
