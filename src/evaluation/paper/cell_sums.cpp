// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/paper/cell_sums.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "evaluation/intervals/pooled_estimate.h"
#include "metrics/metric_registry.h"

namespace cdiff::evaluation {

metrics::PoolingRule poolingAt(const std::string& place) {
  const auto& all = metrics::measureDefinitions();
  const auto found = std::find_if(
      all.begin(), all.end(), [&](const auto& definition) { return place == definition.place; });
  return found == all.end() ? metrics::kPlainMean : metrics::poolingOf(*found);
}

CellSums::CellSums(const std::vector<const BatchRun*>& runs, const std::string& key,
                   const std::string& weight) {
  for (const BatchRun* run : runs) {
    const auto value = run->number(key);
    const double share = weight.empty() ? 1.0 : run->number(weight).value_or(0.0);
    if (value && share > 0.0) add(*run, *value, share);
  }
}

void CellSums::add(const BatchRun& run, double value, double share) {
  const auto& factors = run.record.factors;
  const std::size_t seed = seeds_.emplace(factors.at("seed"), seeds_.size()).first->second;
  const std::size_t route = names_.emplace(factors.at("scenario"), names_.size()).first->second;
  if (route == routes_.size()) routes_.emplace_back();
  RouteSum& sum = routes_[route][seed];
  sum.sum += share * value;
  sum.weight += share;
  events_ += std::round(share * value / 1000.0);
  kilometers_ += share / 1000.0;
  ++used_;
}

std::size_t CellSums::events() const { return static_cast<std::size_t>(std::llround(events_)); }

Statistics CellSums::overSeeds(RouteBootstrap& bootstrap, const metrics::PoolingRule& rule) const {
  Statistics statistics = statisticsOf(seedMeans(allRoutes()));
  statistics.interval = bootstrap.interval(routes(), [&](const std::uint32_t* first) {
    return statisticsOf(seedMeans({first, first + routes()})).mean;
  });
  const bool bounded = std::isfinite(rule.least) && std::isfinite(rule.most);
  if (!statistics.interval && bounded && routes() > 1)
    statistics.interval = unseenInterval(*statistics.mean, rule.least, rule.most, routes());
  return statistics;
}

Statistics CellSums::ofEvents(RouteBootstrap& bootstrap) const {
  Statistics statistics = statisticsOf(seedMeans(allRoutes()));
  statistics.interval = std::nullopt;
  if (used_ == 0) return statistics;
  statistics.mean = events_ / kilometers_;
  statistics.interval =
      rateInterval(events(), kilometers_, bootstrap.valueInterval(perKilometer()));
  return statistics;
}

std::optional<double> CellSums::figure(const std::vector<std::uint32_t>& drawn,
                                       const metrics::PoolingRule& rule) const {
  if (rule.kind == metrics::Pooling::kRate) return pooledValue(seedSums(drawn));
  return statisticsOf(seedMeans(drawn)).mean;
}

/// Events and km of each route.
RouteSums CellSums::perKilometer() const {
  RouteSums sums;
  for (const auto& route : routes_) {
    sums.emplace_back();
    for (const auto& [seed, sum] : route) {
      sums.back().sum += sum.sum / 1000.0;
      sums.back().weight += sum.weight / 1000.0;
    }
  }
  return sums;
}

std::vector<std::uint32_t> CellSums::allRoutes() const {
  std::vector<std::uint32_t> all(routes());
  std::iota(all.begin(), all.end(), 0U);
  return all;
}

/// Of these routes, by seed.
RouteSums CellSums::seedSums(const std::vector<std::uint32_t>& drawn) const {
  RouteSums sums(seeds_.size());
  for (const std::uint32_t route : drawn) {
    for (const auto& [seed, sum] : routes_[route]) {
      sums[seed].sum += sum.sum;
      sums[seed].weight += sum.weight;
    }
  }
  return sums;
}

std::vector<double> CellSums::seedMeans(const std::vector<std::uint32_t>& drawn) const {
  std::vector<double> means;
  for (const RouteSum& sum : seedSums(drawn)) {
    if (sum.weight > 0.0) means.push_back(sum.sum / sum.weight);
  }
  return means;
}

}  // namespace cdiff::evaluation
