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

/// How decisions are collected.
struct PpoCollectorOptions {
  std::int64_t environments = 4;    ///< sessions side by side; the result depends on their number
  std::int64_t workers = 2;         ///< threads that drive them; the result does not depend on it
  std::int64_t buffer = 4096;       ///< decisions of an iteration, at least
  std::string simulator = "lanes";  ///< lanes (simulation/lane_traffic.h) | sumo
  std::int64_t seed = 1;
};

/// Drives sessions and collects the episodes of their CBVs: environments in parallel, each in its
/// own thread with a simulator of its own. The environments of an iteration start anew, from draws
/// of seed, iteration and environment alone, so an iteration can be repeated by itself.
class PpoCollector {
 public:
  /// `routes` and `stop` must outlive the object.
  PpoCollector(const PpoRoutes& routes, const PpoCollectorOptions& options,
               const std::atomic<bool>& stop)
      : routes_(routes), options_(options), stop_(stop) {}

  /// At least `buffer` decisions of the exploring actor on training routes, in the order of the
  /// environments. Throws core::Interrupted when stopped, core::Error when a session fails or no
  /// session has a CBV.
  std::vector<PpoEpisode> explore(const PpoActor& actor, std::int64_t iteration) const;

  /// The episodes of one session on each held-out route, `rounds` times with other seeds, driven by
  /// tanh(mean). Throws as explore does.
  std::vector<PpoEpisode> judge(const PpoActor& actor, std::int64_t rounds) const;

 private:
  using Job = std::function<std::vector<PpoEpisode>()>;
  /// Runs the jobs in the threads and joins their episodes in the order of the jobs.
  std::vector<PpoEpisode> run(const std::vector<Job>& jobs) const;
  std::vector<PpoEpisode> environment(const PpoActor& actor, std::int64_t iteration,
                                      std::int64_t number) const;
  /// One session to its end, or until `most` decisions were rewarded.
  std::vector<PpoEpisode> session(std::size_t route, std::int64_t seed, const PpoPolicy& policy,
                                  std::size_t most) const;

  const PpoRoutes& routes_;
  PpoCollectorOptions options_;
  const std::atomic<bool>& stop_;
};

}  // namespace cdiff::planners
