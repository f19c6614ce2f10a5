// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "e2e_cdiff/metrics/metric.h"
#include "evaluation/intervals/intervals.h"
#include "evaluation/run_record.h"
#include "evaluation/statistics.h"

namespace cdiff::evaluation {

/// The rule of the measure at a place of summary.json; a plain mean where there is none.
metrics::PoolingRule poolingAt(const std::string& place);

/// What the runs of a cell add to a figure, by route and seed.
class CellSums {
 public:
  /// Complete runs that have `key`; those of weight 0 are skipped. An empty `weight`: all alike.
  CellSums(const std::vector<const BatchRun*>& runs, const std::string& key,
           const std::string& weight);

  std::size_t used() const { return used_; }
  std::size_t routes() const { return routes_.size(); }
  /// Where values are per km and weights meters.
  std::size_t events() const;
  double kilometers() const { return kilometers_; }

  /// Mean and deviation over seeds of the weighted means within them; interval by routes, of a
  /// bounded figure that is the same on all of them by those that were not seen.
  Statistics overSeeds(RouteBootstrap& bootstrap, const metrics::PoolingRule& rule) const;
  /// The same of events per km, where weights are meters: pooled over seeds.
  Statistics ofEvents(RouteBootstrap& bootstrap) const;

  /// The figure over these routes (places in `names`): the mean over seeds, or of a rate the pooled
  /// one; nullopt without a run.
  std::optional<double> figure(const std::vector<std::uint32_t>& drawn,
                               const metrics::PoolingRule& rule) const;
  /// Places of routes by name.
  const std::map<std::string, std::size_t>& names() const { return names_; }

 private:
  void add(const BatchRun& run, double value, double share);
  RouteSums perKilometer() const;
  std::vector<std::uint32_t> allRoutes() const;
  RouteSums seedSums(const std::vector<std::uint32_t>& drawn) const;
  std::vector<double> seedMeans(const std::vector<std::uint32_t>& drawn) const;

  std::map<std::string, std::size_t> seeds_;  ///< places by name
  std::map<std::string, std::size_t> names_;  ///< of routes
  std::vector<std::map<std::size_t, RouteSum>> routes_;
  std::size_t used_ = 0;
  double events_ = 0.0;
  double kilometers_ = 0.0;
};

}  // namespace cdiff::evaluation
