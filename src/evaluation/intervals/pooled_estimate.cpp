// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/intervals/pooled_estimate.h"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <set>
#include <utility>

#include "core/text.h"
#include "metrics/known_measures.h"
#include "metrics/metric_registry.h"

namespace cdiff::evaluation {

namespace {

using metrics::Pooling;
using metrics::PoolingRule;
using metrics::SessionWeight;

std::optional<double> measureOf(const RunRecord& record, const std::string& name) {
  const auto found = record.measures.find(name);
  return found == record.measures.end() ? std::nullopt : std::optional<double>(found->second);
}

std::optional<double> kilometers(const std::optional<double>& meters) {
  return meters ? std::optional<double>(*meters / 1000.0) : std::nullopt;
}

/// What a run weighs; nullopt where its record does not say.
std::optional<double> weightOf(const RunRecord& record, SessionWeight weight) {
  namespace known = metrics::known;
  switch (weight) {
    case SessionWeight::kEgoKilometres:
      return kilometers(measureOf(record, known::kEgoDistance.name));
    case SessionWeight::kCbvKilometres:
      return kilometers(measureOf(record, known::kCbvDistance.name));
    case SessionWeight::kCbvDecisions:
      return measureOf(record, known::kCbvDecisions.name);
    case SessionWeight::kCbvSelections: {
      const auto selections = measureOf(record, kSelectionCount);
      return selections ? selections : measureOf(record, known::kCbvCount.name);  // earlier records
    }
    case SessionWeight::kSeconds:
      return record.simulated_seconds;
    case SessionWeight::kTtcSeconds: {
      const auto percent = measureOf(record, known::kTtcDefined.name);
      return percent ? std::optional<double>(record.simulated_seconds * *percent / 100.0)
                     : std::nullopt;
    }
    case SessionWeight::kByKind:
    case SessionWeight::kOne:
      break;
  }
  return 1.0;
}

bool bounded(const PoolingRule& rule) {
  return std::isfinite(rule.least) && std::isfinite(rule.most);
}

/// Pearson's chi-square of counts against one rate.
double chiSquare(const RouteSums& routes, double rate) {
  double sum = 0.0;
  for (const RouteSum& route : routes) {
    const double expected = rate * route.weight;
    if (expected > 0.0) sum += (route.sum - expected) * (route.sum - expected) / expected;
  }
  return sum;
}

void addDispersion(const RouteSums& routes, PooledEstimate& estimate) {
  // Routes without exposure, as without a CBV, say nothing.
  const auto exposed = std::count_if(routes.begin(), routes.end(),
                                     [](const RouteSum& route) { return route.weight > 0.0; });
  if (exposed < 2 || estimate.events == 0) return;
  const auto freedom = static_cast<double>(exposed - 1);
  const double chi_square = chiSquare(routes, *estimate.value);
  estimate.dispersion = chi_square / freedom;
  estimate.over_dispersed =
      chi_square > boost::math::quantile(boost::math::chi_squared(freedom), 0.95);
}

void addCount(const RouteSums& routes, RouteBootstrap& bootstrap, PooledEstimate& estimate) {
  double events = 0.0;
  for (const RouteSum& route : routes) {
    events += route.sum;
    estimate.exposure += route.weight;
  }
  estimate.events = static_cast<std::size_t>(std::llround(events));
  if (!estimate.value) return;
  estimate.clustered = bootstrap.valueInterval(routes);
  estimate.interval = rateInterval(estimate.events, estimate.exposure, estimate.clustered);
  const Interval alone = rateInterval(estimate.events, estimate.exposure, std::nullopt);
  const bool wider = estimate.interval->low < alone.low || estimate.interval->high > alone.high;
  estimate.interval_kind = wider ? IntervalKind::kWider : IntervalKind::kPoisson;
  addDispersion(routes, estimate);
}

void addInterval(const RouteSums& routes, const PoolingRule& rule, RouteBootstrap& bootstrap,
                 PooledEstimate& estimate) {
  estimate.interval = bootstrap.valueInterval(routes);
  estimate.interval_kind = IntervalKind::kRoutes;
  if (estimate.interval) return;
  estimate.interval_kind = IntervalKind::kNone;
  if (!bounded(rule) || routes.size() < 2 || !estimate.value) return;
  estimate.interval = unseenInterval(*estimate.value, rule.least, rule.most, routes.size());
  estimate.interval_kind = IntervalKind::kUnseen;
}

/// How a batch sums up the measures that no metric defines; a plain mean for an unknown name.
metrics::PoolingRule batchPooling(const std::string& measure) {
  constexpr PoolingRule kShareOfCbvs = {Pooling::kShare, SessionWeight::kCbvSelections, 0.0, 100.0};
  static const std::map<std::string, PoolingRule> rules = {
      {"cbv_passed_percent", kShareOfCbvs},
      {"cbv_completion_percent", kShareOfCbvs},
      {"cbv_interactions_percent", kShareOfCbvs},
      {"cbv_close_interactions_percent", kShareOfCbvs},
      {"guidance_trust_region_share", metrics::kMeanToOne}};
  const auto rule = rules.find(measure);
  return rule != rules.end() ? rule->second : metrics::kPlainMean;
}

}  // namespace

PoolingRule poolingOfMeasure(const std::string& measure) {
  const metrics::MeasureDefinition* definition = metrics::findMeasure(measure);
  return definition != nullptr ? metrics::poolingOf(*definition) : batchPooling(measure);
}

const char* toText(IntervalKind kind) {
  switch (kind) {
    case IntervalKind::kRoutes:
      return "bootstrap";
    case IntervalKind::kPoisson:
      return "poisson";
    case IntervalKind::kWider:
      return "poisson or bootstrap";
    case IntervalKind::kUnseen:
      return "unseen";
    case IntervalKind::kNone:
      break;
  }
  return "none";
}

ClusterSums::ClusterSums(std::string measure, const PoolingRule& rule, bool per_km)
    : measure_(std::move(measure)), rule_(rule), per_km_(per_km) {}

bool ClusterSums::add(const RunRecord& record, const std::string& cluster) {
  const auto value = measureOf(record, measure_);
  const auto weight = per_km_ ? weightOf(record, rule_.weight) : 1.0;
  if (!value || !weight) return false;
  const bool count = rule_.kind == Pooling::kCount;
  if (*weight <= 0.0 && !count) return false;  // events without distance count all the same
  double sum = *weight * *value;
  if (count) sum = *value;
  if (rule_.kind == Pooling::kRate) sum = std::round(sum);
  RouteSum& route = sums_[cluster];
  route.sum += sum;
  route.weight += *weight;
  ++runs_;
  return true;
}

void ClusterSums::addValue(double value, const std::string& cluster) {
  RouteSum& route = sums_[cluster];
  route.sum += value;
  route.weight += 1.0;
  ++runs_;
}

RouteSums ClusterSums::sums() const {
  RouteSums sums;
  for (const auto& [cluster, sum] : sums_) sums.push_back(sum);
  return sums;
}

PooledEstimate ClusterSums::estimate(RouteBootstrap& bootstrap) const {
  const RouteSums routes = sums();
  PooledEstimate estimate;
  estimate.kind = rule_.kind;
  estimate.per_km = per_km_;
  estimate.runs = runs_;
  estimate.routes = routes.size();
  estimate.value = pooledValue(routes);
  if (estimate.counts()) {
    addCount(routes, bootstrap, estimate);
  } else {
    addInterval(routes, rule_, bootstrap, estimate);
  }
  return estimate;
}

bool knowDistances(const std::vector<const RunRecord*>& runs, const PoolingRule& rule,
                   const std::string& measure) {
  if (rule.kind != Pooling::kCount) return true;
  return std::all_of(runs.begin(), runs.end(), [&](const RunRecord* run) {
    return !measureOf(*run, measure) || weightOf(*run, rule.weight);
  });
}

PooledEstimate pooledEstimate(const std::vector<const RunRecord*>& runs, const std::string& measure,
                              RouteBootstrap& bootstrap, const std::string& cluster) {
  const PoolingRule rule = poolingOfMeasure(measure);
  ClusterSums sums(measure, rule, knowDistances(runs, rule, measure));
  std::set<std::string> seeds;
  for (const RunRecord* run : runs) {
    if (sums.add(*run, run->factors.at(cluster))) seeds.insert(run->factors.at("seed"));
  }
  PooledEstimate estimate = sums.estimate(bootstrap);
  estimate.seeds = seeds.size();
  return estimate;
}

Interval rateInterval(std::size_t events, double exposure,
                      const std::optional<Interval>& by_routes) {
  const Interval expected = poissonInterval(events);
  Interval interval{expected.low / exposure, expected.high / exposure};
  if (!by_routes) return interval;
  return {std::min(interval.low, by_routes->low), std::max(interval.high, by_routes->high)};
}

Interval unseenInterval(double value, double least, double most, std::size_t routes) {
  const double unseen = largestShareUnseen(routes);
  return {value + unseen * (least - value), value + unseen * (most - value)};
}

std::string intervalText(const std::optional<Interval>& interval, int decimals) {
  if (!interval) return "";
  return " [" + core::formatFixed(interval->low, decimals) + ", " +
         core::formatFixed(interval->high, decimals) + "]";
}

std::string intervalRule(const std::string& clusters) {
  return "A row shows the intervals of all its figures or none: it needs " +
         std::to_string(kLeastRoutes) + " " + clusters +
         ". The JSON and CSV files hold every interval that can be computed.";
}

std::string estimateText(const PooledEstimate& estimate, int decimals, bool with_interval) {
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
         (with_interval ? intervalText(estimate.interval, decimals) : "");
}

std::string probabilityText(double p) { return p < 0.001 ? "< 0.001" : core::formatFixed(p, 3); }

std::string estimateNote(const PooledEstimate& estimate, bool with_interval) {
  if (estimate.counts() && !estimate.per_km) return "no record says the km: per run";
  if (estimate.over_dispersed) {
    return "routes differ more than chance does (dispersion " +
           core::formatFixed(*estimate.dispersion, 1) + ")" +
           (with_interval ? ", interval by routes" + intervalText(estimate.clustered) : "");
  }
  if (!with_interval || !estimate.value) return "";
  if (!estimate.interval) {
    return "no interval: " + (estimate.routes < 2 ? "one route has it"
                                                  : std::string("the same on all routes, without "
                                                                "bounds"));
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
            (!showsIntervals(clusters) ? ": too few for bootstrap intervals, which need " +
                                             std::to_string(kLeastRoutes) + "."
                                       : ": intervals by the bootstrap may be too narrow below " +
                                             std::to_string(kLeastClusters) + ".");
  }
  return text;
}

}  // namespace cdiff::evaluation
