// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "e2e_cdiff/core/random.h"
#include "learning/samples/driving_sample.h"

namespace cdiff::learning {

// How often samples come in training: rare maneuvers and speeds more often than their share, so
// that turns, starts and stops are not lost among straight driving.

constexpr double kStanding = 0.3;  ///< slower vehicles stand [m/s]
constexpr double kMoving = 2.0;    ///< faster ones move [m/s]

/// What is balanced: the maneuver (straight, left, right, other) and the pace (standing, starting,
/// stopping, slow below 4 m/s, middle, fast above 8 m/s), as in "left starting".
std::string balanceClass(const DrivingSample& sample);

/// Weight of each training sample, n^-balance for a class of n samples, mean 1, at most kMostWeight
/// before that: 0 gives all the same weight, 1 makes every class come equally often. Those that
/// stop to give way come `yielding_share` times as often: what they wait for is rarely in the
/// image. Throws InputError if nothing is left.
std::vector<double> balanceWeights(const DrivingDataset& dataset, double balance,
                                   double yielding_share = 1.0);
constexpr double kMostWeight = 10.0;

/// An epoch: as many indices as there are weights; index i comes floor or ceil of weight_i times
/// (systematic sampling), in random order. Draws are those of `random` with key {0, epoch}.
std::vector<std::size_t> drawEpoch(const std::vector<double>& weights,
                                   const core::RandomStream& random, std::int64_t epoch);

/// Which samples come at which step: a function of (stream, step), whatever came before.
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
