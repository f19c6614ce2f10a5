// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "learning/sample_order.h"

#include <algorithm>
#include <utility>

namespace cdiff::learning {

std::vector<std::size_t> drawEpoch(const std::vector<double>& weights,
                                   const core::RandomStream& random, std::int64_t epoch) {
  const core::RandomKey key{0, static_cast<std::uint32_t>(epoch)};
  std::vector<std::size_t> drawn;
  double reached = random.uniform(key, 0);
  double sum = 0.0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    sum += weights[i];
    for (; reached < sum && drawn.size() < weights.size(); reached += 1.0) drawn.push_back(i);
  }
  while (drawn.size() < weights.size()) drawn.push_back(weights.size() - 1);  // rounding
  for (std::size_t i = drawn.size(); i > 1; --i)
    std::swap(drawn[i - 1], drawn[random.index(key, static_cast<std::uint32_t>(i), i)]);
  return drawn;
}

SampleOrder::SampleOrder(std::vector<std::size_t> samples, std::vector<double> weights,
                         std::int64_t batch, const core::RandomStream& random)
    : samples_(std::move(samples)), weights_(std::move(weights)), batch_(batch), random_(random) {}

std::vector<std::size_t> SampleOrder::at(std::int64_t step) {
  const auto count = static_cast<std::int64_t>(samples_.size());
  std::vector<std::size_t> chosen;
  for (std::int64_t place = step * batch_; place < (step + 1) * batch_; ++place) {
    const std::int64_t epoch = place / count;
    if (epoch_ != epoch) {
      epoch_ = epoch;
      drawn_ = drawEpoch(weights_, random_, epoch);
    }
    chosen.push_back(samples_[drawn_[static_cast<std::size_t>(place % count)]]);
  }
  return chosen;
}

}  // namespace cdiff::learning
