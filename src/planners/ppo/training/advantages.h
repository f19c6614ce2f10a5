// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <vector>

namespace cdiff::planners {

/// One decision with what the critic expected before and after it.
struct PpoValued {
  double reward = 0.0;
  double value = 0.0;       ///< V of the state that was decided in
  double next_value = 0.0;  ///< V of the state that it led to; not used where `terminal`
  bool terminal = false;    ///< the episode ended with it: nothing comes after
  bool last = false;        ///< the next decision belongs to another episode
};

/// Generalized advantage estimates (Schulman et al. 2016): A_t = delta_t + discount decay A_t+1
/// within an episode, delta_t = r_t + discount V_t+1 - V_t, V_t+1 = 0 after a terminal decision.
/// Decisions of an episode follow each other, in order.
std::vector<double> ppoAdvantages(const std::vector<PpoValued>& decisions, double discount,
                                  double decay);

/// The advantages less their mean, over their standard deviation (n - 1) + 1e-5; at least two.
std::vector<double> ppoNormalized(const std::vector<double>& advantages);

/// Mean difference of two series with its 95 % interval, from normal approximation and unequal
/// variances (Welch).
struct PpoDifference {
  double first = 0.0;   ///< mean
  double second = 0.0;  ///< mean
  double low = 0.0;     ///< of second - first
  double high = 0.0;
};

/// Throws std::invalid_argument with fewer than two values in one of them.
PpoDifference ppoDifference(const std::vector<double>& first, const std::vector<double>& second);

}  // namespace cdiff::planners
