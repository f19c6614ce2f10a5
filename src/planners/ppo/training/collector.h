// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "planners/ppo/training/episodes.h"
#include "planners/ppo/training/training_routes.h"

namespace cdiff::planners {

/// How decisions are collected in each iteration.
struct PpoCollectorOptions {
  std::int64_t environments = 4;    ///< sessions side by side; the result depends on their number
  std::int64_t workers = 2;         ///< threads that drive them; the result does not depend on it
  std::int64_t buffer = 4096;       ///< least number of decisions per iteration
  std::string simulator = "lanes";  ///< lanes (simulation/lane_traffic.h) | sumo
  std::int64_t seed = 1;
};

/// Drives sessions and collects the episodes of their CBVs: environments in parallel, each in its
/// own thread with its own simulator. In every iteration the environments start from scratch, with
/// draws that depend only on seed, iteration and environment, so any iteration can be repeated
/// alone. Used by the task `ppo`.
class PpoCollector {
 public:
  /// `routes` and `stop` must outlive the object.
  PpoCollector(const PpoRoutes& routes, const PpoCollectorOptions& options,
               const std::atomic<bool>& stop)
      : routes_(routes), options_(options), stop_(stop) {}

  /// At least `buffer` decisions of the exploring actor on training routes, in the order of the
  /// environments. Throws core::Interrupted when stopped, core::Error when a session fails or none
  /// has a CBV.
  std::vector<PpoEpisode> explore(const PpoActor& actor, std::int64_t iteration) const;

  /// The episodes of one session on each held-out route, repeated `rounds` times with other seeds
  /// and driven by the mean action tanh(mean). Throws as explore does.
  std::vector<PpoEpisode> evaluate(const PpoActor& actor, std::int64_t rounds) const;

 private:
  using Job = std::function<std::vector<PpoEpisode>()>;
  /// Runs the jobs in `workers` threads and concatenates their episodes in the order of the jobs.
  std::vector<PpoEpisode> run(const std::vector<Job>& jobs) const;
  std::vector<PpoEpisode> environment(const PpoActor& actor, std::int64_t iteration,
                                      std::int64_t number) const;
  /// Drives one session to its end, or until `most` decisions have been rewarded.
  std::vector<PpoEpisode> session(std::size_t route, std::int64_t seed, const PpoPolicy& policy,
                                  std::size_t most) const;

  const PpoRoutes& routes_;
  PpoCollectorOptions options_;
  const std::atomic<bool>& stop_;
};

}  // namespace cdiff::planners
