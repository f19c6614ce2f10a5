// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/intervals/estimate_text.h"

#include "core/text.h"

namespace cdiff::evaluation {

std::string intervalText(const std::optional<Interval>& interval, int decimals) {
  if (!interval) return "";
  return " [" + core::formatFixed(interval->low, decimals) + ", " +
         core::formatFixed(interval->high, decimals) + "]";
}

std::string estimateText(const PooledEstimate& estimate, int decimals) {
  std::string text;
  if (estimate.counts()) {
    text = std::to_string(estimate.events) + " / " +
           (estimate.per_km ? core::formatFixed(estimate.exposure, 3) + " km"
                            : core::formatFixed(estimate.exposure, 0) + " runs");
    if (!estimate.value) return text;
    text += " = ";
  }
  if (!estimate.value) return "-";
  return text + core::formatFixed(*estimate.value, decimals) +
         intervalText(estimate.interval, decimals);
}

std::string probabilityText(double p) { return p < 0.001 ? "< 0.001" : core::formatFixed(p, 3); }

std::string estimateNote(const PooledEstimate& estimate) {
  if (estimate.counts() && !estimate.per_km) return "no record says the km: per run";
  if (estimate.over_dispersed) {
    return "routes differ more than chance does (dispersion " +
           core::formatFixed(*estimate.dispersion, 1) + "), interval by routes" +
           intervalText(estimate.clustered);
  }
  return estimate.interval_kind == IntervalKind::kUnseen
             ? "the same on all routes: interval by unseen routes"
             : "";
}

std::string countText(std::size_t count, const std::string& noun) {
  return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

std::string fewWarning(std::size_t seeds, std::size_t clusters, bool routes) {
  constexpr std::size_t kLeastClusters = 10;
  std::string text;
  if (seeds < kLeastSeeds) {
    text = "only " + countText(seeds, "seed") + "; a figure needs at least " +
           std::to_string(kLeastSeeds) + " (`--seeds 1,2,3,4,5`).";
  }
  if (clusters < kLeastClusters) {
    const std::string noun = routes ? "route" : "cluster";
    text += std::string(text.empty() ? "" : " ") + "Only " + countText(clusters, noun) +
            (clusters < 2 ? ": no interval but that of a count says what other routes would give."
                          : ": intervals by the bootstrap may be too narrow below " +
                                std::to_string(kLeastClusters) + ".");
  }
  return text;
}

}  // namespace cdiff::evaluation
