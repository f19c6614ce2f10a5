// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/ppo/training/advantages.h"

#include <cmath>
#include <numeric>
#include <stdexcept>

namespace cdiff::planners {
namespace {

double meanOfAll(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double varianceOf(const std::vector<double>& values, double mean) {
  double sum = 0.0;
  for (const double value : values) sum += (value - mean) * (value - mean);
  return sum / static_cast<double>(values.size() - 1);
}

}  // namespace

std::vector<double> ppoAdvantages(const std::vector<PpoValued>& decisions, double discount,
                                  double decay) {
  std::vector<double> advantages(decisions.size());
  double after = 0.0;
  for (std::size_t t = decisions.size(); t-- > 0;) {
    const PpoValued& decision = decisions[t];
    const double next = decision.terminal ? 0.0 : discount * decision.next_value;
    if (decision.last) after = 0.0;
    after = decision.reward + next - decision.value + discount * decay * after;
    advantages[t] = after;
  }
  return advantages;
}

std::vector<double> ppoNormalized(const std::vector<double>& advantages) {
  constexpr double kLeastDeviation = 1e-5;
  if (advantages.size() < 2) throw std::invalid_argument("PPO: fewer than two advantages");
  const double mean = meanOfAll(advantages);
  const double deviation = std::sqrt(varianceOf(advantages, mean)) + kLeastDeviation;
  std::vector<double> normalized;
  normalized.reserve(advantages.size());
  for (const double advantage : advantages) normalized.push_back((advantage - mean) / deviation);
  return normalized;
}

PpoDifference ppoDifference(const std::vector<double>& first, const std::vector<double>& second) {
  constexpr double kQuantile = 1.959963984540054;  // of the normal distribution, 97.5 %
  if (first.size() < 2 || second.size() < 2)
    throw std::invalid_argument("PPO: fewer than two values to compare");
  PpoDifference difference;
  difference.first = meanOfAll(first);
  difference.second = meanOfAll(second);
  const double variance =
      varianceOf(first, difference.first) / static_cast<double>(first.size()) +
      varianceOf(second, difference.second) / static_cast<double>(second.size());
  const double half = kQuantile * std::sqrt(variance);
  difference.low = difference.second - difference.first - half;
  difference.high = difference.second - difference.first + half;
  return difference;
}

}  // namespace cdiff::planners
