// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Which samples come at which step: a function of (stream, step), whatever came before.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "e2e_cdiff/core/random.h"

namespace cdiff::learning {

/// An epoch: as many indices as there are weights; index i comes floor or ceil of weight_i times
/// (systematic sampling), in random order. Draws are those of `random` with key {0, epoch}.
std::vector<std::size_t> drawEpoch(const std::vector<double>& weights,
                                   const core::RandomStream& random, std::int64_t epoch);

class SampleOrder {
 public:
  /// `weights` of `samples`, one each: how often they come, mean 1. Draws are those of `random`.
  SampleOrder(std::vector<std::size_t> samples, std::vector<double> weights, std::int64_t batch,
              const core::RandomStream& random);

  /// The samples of a step, `batch` of them.
  std::vector<std::size_t> at(std::int64_t step);

 private:
  std::vector<std::size_t> samples_;
  std::vector<double> weights_;
  std::int64_t batch_;
  core::RandomStream random_;
  std::optional<std::int64_t> epoch_;
  std::vector<std::size_t> drawn_;  ///< places in `samples_`, of the epoch
};

}  // namespace cdiff::learning
