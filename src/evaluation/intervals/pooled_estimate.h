// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "e2e_cdiff/metrics/metric.h"
#include "evaluation/intervals/intervals.h"
#include "evaluation/run_record.h"

namespace cdiff::evaluation {

/// The rule by which batches sum up a measure: that of its definition in metrics, or of the batch
/// itself for the few that a batch adds. A plain mean for an unknown name.
metrics::PoolingRule poolingOfMeasure(const std::string& measure);

/// How an interval was made.
enum class IntervalKind {
  kNone,     ///< too few routes, or an unbounded figure without spread
  kRoutes,   ///< bootstrap clustered on routes
  kPoisson,  ///< exact, of a count, which holds that of the bootstrap by routes
  kWider,    ///< of a count: from the lower to the upper end of both
  kUnseen,   ///< routes all alike: by the share of routes that may differ unseen
};

/// "bootstrap", "poisson", "poisson or bootstrap", "unseen" or "none".
const char* toText(IntervalKind kind);

/// A measure over the runs of one system: its value, 95 % interval, and on what it stands.
struct PooledEstimate {
  metrics::Pooling kind = metrics::Pooling::kMean;
  std::optional<double> value;  ///< in the measure's unit; counts per km (or per run)
  std::optional<Interval> interval;
  IntervalKind interval_kind = IntervalKind::kNone;
  std::size_t runs = 0;    ///< that have the measure
  std::size_t routes = 0;  ///< of them
  std::size_t seeds = 0;
  std::size_t events = 0;  ///< of a count or rate
  double exposure = 0.0;   ///< km, or runs where no run says how far it drove
  bool per_km = true;      ///< what `exposure` counts
  /// Of a count: Pearson's chi-square of the routes' counts / (routes - 1); 1 for a Poisson process
  /// that is the same on all routes. Absent below two routes or without events.
  std::optional<double> dispersion;
  bool over_dispersed = false;        ///< whether it is above the 95 % quantile of chi-square
  std::optional<Interval> clustered;  ///< of a count: its rate's interval by the bootstrap

  bool counts() const {
    return kind == metrics::Pooling::kCount || kind == metrics::Pooling::kRate;
  }
};

/// Adds runs to the sums of their clusters (routes, or the seeds of one route).
class ClusterSums {
 public:
  ClusterSums(std::string measure, const metrics::PoolingRule& rule, bool per_km);

  /// Whether it was added: a run without the measure, or of unknown or no weight, is not.
  bool add(const RunRecord& record, const std::string& cluster);
  /// One value of weight 1: the mean of runs that count as one.
  void addValue(double value, const std::string& cluster);
  RouteSums sums() const;
  /// Sums of these clusters, in this order; zero where there is none.
  const std::map<std::string, RouteSum>& byCluster() const { return sums_; }
  /// The same as an estimate with its interval.
  PooledEstimate estimate(RouteBootstrap& bootstrap) const;

 private:
  std::string measure_;
  metrics::PoolingRule rule_;
  bool per_km_;
  std::size_t runs_ = 0;
  std::map<std::string, RouteSum> sums_;
};

/// Whether every one of the runs that has a count says the distance for it.
bool knowDistances(const std::vector<const RunRecord*>& runs, const metrics::PoolingRule& rule,
                   const std::string& measure);

/// A measure over complete runs; `cluster`: the factor whose levels are drawn, "scenario" for
/// routes.
PooledEstimate pooledEstimate(const std::vector<const RunRecord*>& runs, const std::string& measure,
                              RouteBootstrap& bootstrap, const std::string& cluster = "scenario");

/// Interval of the rate of events in `exposure` km: the exact Poisson interval, or where the
/// bootstrap by routes (absent below two routes) reaches farther, up to its end: events of one
/// route are not independent, and a bootstrap of few events is too narrow.
Interval rateInterval(std::size_t events, double exposure,
                      const std::optional<Interval>& by_routes);

/// Interval of a bounded figure all of whose `routes` have the same `value`: at most
/// largestShareUnseen(routes) of the routes differ, by as much as the bounds allow.
Interval unseenInterval(double value, double least, double most, std::size_t routes);

// Estimates as text for people, in Markdown and HTML alike.

/// Fewer seeds than these are warned of.
inline constexpr std::size_t kLeastSeeds = 5;

/// Fewest routes of a row of a table that shows intervals. A row shows all of its intervals or
/// none; below, the bootstrap's quantiles are the lowest and the highest route, which estimate
/// nothing, and on one route a count alone would have an interval.
inline constexpr std::size_t kLeastRoutes = 5;

/// Whether a row of a table whose runs lie on so many routes shows intervals.
inline bool showsIntervals(std::size_t routes) { return routes >= kLeastRoutes; }

/// What stands under a table of which some rows show no intervals; `clusters`: what is drawn.
std::string intervalRule(const std::string& clusters = "routes");

/// "20.123 [18.4, 22.0]", of counts "7 / 1.520 km = 4.605 [1.851, 9.488]"; "-" without a value.
std::string estimateText(const PooledEstimate& estimate, int decimals, bool with_interval);

/// " [18.400, 22.000]", or nothing.
std::string intervalText(const std::optional<Interval>& interval, int decimals = 3);

/// "0.012", "< 0.001".
std::string probabilityText(double p);

/// What a reader has to know of it: over-dispersed, no distances, routes all alike, an interval
/// that the row's other cells have and this one has not; or nothing.
std::string estimateNote(const PooledEstimate& estimate, bool with_interval);

/// "1 route", "10 routes".
std::string countText(std::size_t count, const std::string& noun);

/// A sentence where there are fewer than kLeastSeeds seeds, or so few clusters (routes, or what
/// else was drawn) that intervals say little; else nothing.
std::string fewWarning(std::size_t seeds, std::size_t clusters, bool routes);

}  // namespace cdiff::evaluation
