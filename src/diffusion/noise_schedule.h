// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <vector>

namespace cdiff::diffusion {

/// Squared-cosine schedule: alpha_bar(k) = cos^2((k/K + 0.008) / 1.008 pi/2) / the same at 0,
/// beta_k = min(1 - alpha_bar(k) / alpha_bar(k-1), 0.999), k = 1..K; all in double.
class NoiseSchedule {
 public:
  /// Throws InputError for K < 1.
  explicit NoiseSchedule(int steps);

  int steps() const { return static_cast<int>(beta_.size()) - 1; }
  double beta(int k) const { return beta_[static_cast<std::size_t>(k)]; }
  /// Product of (1 - beta) up to k; 1 at k = 0.
  double alphaBar(int k) const { return alpha_bar_[static_cast<std::size_t>(k)]; }
  /// Posterior mean = cleanWeight x tau^0 + noisyWeight x tau^k (DDPM).
  double cleanWeight(int k) const;
  double noisyWeight(int k) const;

 private:
  std::vector<double> beta_;       ///< [0..K], beta_[0] = 0
  std::vector<double> alpha_bar_;  ///< [0..K]
};

}  // namespace cdiff::diffusion
