// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/statistics.h"

#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <numeric>
#include <set>
#include <utility>

namespace cdiff::evaluation {

Statistics statisticsOf(const std::vector<double>& samples) {
  Statistics result;
  result.n = samples.size();
  if (samples.empty()) return result;
  const auto n = static_cast<double>(samples.size());
  const double mean = std::accumulate(samples.begin(), samples.end(), 0.0) / n;
  result.mean = mean;
  if (samples.size() < 2) return result;
  double squares = 0.0;
  for (const double sample : samples) squares += (sample - mean) * (sample - mean);
  const double deviation = std::sqrt(squares / (n - 1.0));
  const double t = boost::math::quantile(boost::math::students_t(n - 1.0), 0.975);
  result.standard_deviation = deviation;
  const double half_width = t * deviation / std::sqrt(n);
  result.interval = {mean - half_width, mean + half_width};
  return result;
}

namespace {

using Records = std::vector<const RunRecord*>;

/// Values of one measure in a cell, by seed.
using ValuesBySeed = std::map<std::string, std::vector<double>>;

Statistics meanOverSeeds(const ValuesBySeed& values) {
  std::vector<double> means;
  for (const auto& [seed, samples] : values) {
    means.push_back(std::accumulate(samples.begin(), samples.end(), 0.0) /
                    static_cast<double>(samples.size()));
  }
  return statisticsOf(means);
}

/// Mean over seeds, or the share of all samples together, and its interval.
Statistics cellStatistics(const std::string& name, const ValuesBySeed& values,
                          const Records& records, RouteBootstrap& bootstrap) {
  Statistics statistics = meanOverSeeds(values);
  const metrics::PoolingRule rule = poolingOfMeasure(name);
  const bool count = rule.kind == metrics::Pooling::kCount || rule.kind == metrics::Pooling::kRate;
  if (!count && !std::isfinite(rule.most)) return statistics;
  const PooledEstimate pooled = pooledEstimate(records, name, bootstrap, "seed");
  statistics.interval = pooled.interval;
  if (rule.kind != metrics::Pooling::kShare || !pooled.value) return statistics;
  statistics.mean = *pooled.value;
  statistics.standard_deviation.reset();  // that of the seeds' means is another thing
  return statistics;
}

Cell cellOfGroup(const Factors& factors, const Records& records, RouteBootstrap& bootstrap) {
  Cell cell;
  cell.factors = factors;
  std::map<std::string, ValuesBySeed> values;
  for (const RunRecord* record : records) {
    ++cell.runs;
    cell.failed += record->failed();
    cell.missing += !record->failed() && !record->complete();
    for (const auto& [name, value] : record->measures) {
      values[name][record->factors.at("seed")].push_back(value);
    }
  }
  for (const auto& [name, by_seed] : values)
    cell.measures[name] = cellStatistics(name, by_seed, records, bootstrap);
  return cell;
}

System systemOf(const Factors& factors, const Records& records, RouteBootstrap& bootstrap) {
  System system;
  system.factors = factors;
  Records complete;
  std::set<std::string> routes;
  std::set<std::string> seeds;
  for (const RunRecord* record : records) {
    ++system.runs;
    system.failed += record->failed();
    system.missing += !record->failed() && !record->complete();
    if (!record->complete()) continue;
    complete.push_back(record);
    routes.insert(record->factors.at("scenario"));
    seeds.insert(record->factors.at("seed"));
  }
  system.routes = routes.size();
  system.seeds = seeds.size();
  for (const std::string& name : measureNames()) {
    const PooledEstimate estimate = pooledEstimate(complete, name, bootstrap);
    if (estimate.runs > 0) system.measures[name] = estimate;
  }
  return system;
}

/// Records that agree in all factors but `pooled`, in the order in which they first appear.
std::vector<std::pair<Factors, Records>> groupsOf(const std::vector<RunRecord>& records,
                                                  const std::vector<std::string>& pooled) {
  std::vector<std::pair<Factors, Records>> groups;
  std::map<Factors, std::size_t> places;
  for (const RunRecord& record : records) {
    Factors factors = record.factors;
    for (const std::string& factor : pooled) factors.erase(factor);
    const auto [place, added] = places.emplace(factors, groups.size());
    if (added) groups.emplace_back(factors, Records());
    groups[place->second].second.push_back(&record);
  }
  return groups;
}

}  // namespace

std::vector<Cell> cellsOf(const std::vector<RunRecord>& records) {
  RouteBootstrap bootstrap;
  std::vector<Cell> cells;
  for (const auto& [factors, group] : groupsOf(records, {"seed", "repetition"}))
    cells.push_back(cellOfGroup(factors, group, bootstrap));
  return cells;
}

std::vector<System> systemsOf(const std::vector<RunRecord>& records) {
  RouteBootstrap bootstrap;
  std::vector<System> systems;
  for (const auto& [factors, group] : groupsOf(records, {"scenario", "seed", "repetition"}))
    systems.push_back(systemOf(factors, group, bootstrap));
  return systems;
}

}  // namespace cdiff::evaluation
