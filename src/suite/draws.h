// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>

#include "e2e_cdiff/core/random.h"

namespace cdiff::suite {

/// Draws one after the other from one key of a counter-based stream: the same stream and counter
/// give the same series.
class Draws {
 public:
  /// `counter` names what is drawn: a network, or a route of a suite.
  Draws(const core::RandomStream& random, std::uint32_t counter)
      : random_(random), key_{0, counter, 0} {}

  /// Uniform in [low, high).
  double uniform(double low, double high) { return random_.uniform(key_, element_++, low, high); }
  /// Uniform whole number in [low, high].
  int whole(int low, int high) {
    const auto count = static_cast<std::size_t>(high - low + 1);
    return low + static_cast<int>(random_.index(key_, element_++, count));
  }
  bool chance(double probability) { return uniform(0.0, 1.0) < probability; }
  /// -1 or 1.
  double sign() { return chance(0.5) ? 1.0 : -1.0; }
  template <class List>
  auto pick(const List& list) {
    return list[random_.index(key_, element_++, list.size())];
  }

 private:
  core::RandomStream random_;
  core::RandomKey key_;
  std::uint32_t element_ = 0;
};

}  // namespace cdiff::suite
