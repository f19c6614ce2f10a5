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

// A measure over all runs of a system, with its 95 % interval.

/// The rule by which a batch pools a measure over runs: that of its definition in metrics, or of
/// the batch itself for the few measures that a batch adds. A plain mean for an unknown name.
metrics::PoolingRule poolingOfMeasure(const std::string& measure);

/// How an interval was computed.
enum class IntervalKind {
  kNone,     ///< none: too few routes, or an unbounded measure without spread
  kRoutes,   ///< bootstrap clustered on routes
  kPoisson,  ///< of a count: exact; it contains the bootstrap's
  kWider,    ///< of a count: the union of both
  kUnseen,   ///< all routes equal: from the share that may differ unseen
};

/// "bootstrap", "poisson", "poisson or bootstrap", "unseen" or "none".
const char* toText(IntervalKind kind);

/// A measure pooled over the runs of one system: its value, its 95 % interval, and the number of
/// runs, routes, seeds and events behind it.
struct PooledEstimate {
  metrics::Pooling kind = metrics::Pooling::kMean;
  std::optional<double> value;  ///< in the measure's unit; counts per km (or per run)
  std::optional<Interval> interval;
  IntervalKind interval_kind = IntervalKind::kNone;
  std::size_t runs = 0;    ///< number of runs that have the measure
  std::size_t routes = 0;  ///< of these runs
  std::size_t seeds = 0;   ///< of these runs
  std::size_t events = 0;  ///< of a count or rate
  double exposure = 0.0;   ///< km driven, or number of runs where no distance is known
  bool per_km = true;      ///< whether `exposure` is in km
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

  /// Adds a run; false if it lacks the measure, if its weight is unknown, or 0 unless the measure
  /// is a count.
  bool add(const RunRecord& record, const std::string& cluster);
  /// Adds one value of weight 1: the mean of runs that count as one.
  void addValue(double value, const std::string& cluster);
  RouteSums sums() const;
  /// Sums by cluster name.
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

/// Whether every run that has a count also has the distance it refers to.
bool knowDistances(const std::vector<const RunRecord*>& runs, const metrics::PoolingRule& rule,
                   const std::string& measure);

/// Pools a measure over complete runs; `cluster` is the factor whose levels the bootstrap draws
/// ("scenario": routes).
PooledEstimate pooledEstimate(const std::vector<const RunRecord*>& runs, const std::string& measure,
                              RouteBootstrap& bootstrap, const std::string& cluster = "scenario");

/// Interval of the rate of events per km in `exposure` [km]: the exact Poisson interval, extended
/// to the ends of the bootstrap's by routes (absent below two routes) where these lie outside,
/// because events of one route are not independent and a bootstrap of few events is too narrow.
Interval rateInterval(std::size_t events, double exposure,
                      const std::optional<Interval>& by_routes);

/// Interval of a measure between `least` and `most` that has the same `value` on all `routes`: at
/// most largestShareUnseen(routes) of all routes differ, by as much as the bounds allow.
Interval unseenInterval(double value, double least, double most, std::size_t routes);

// Estimates as text for people, in Markdown and HTML alike.

/// Fewer seeds than this give a warning.
inline constexpr std::size_t kLeastSeeds = 5;

/// A row of a table shows intervals from this number of routes on, all of them or none. With fewer
/// routes the bootstrap's quantiles are the lowest and the highest route, which estimates nothing,
/// and on one route only a count would have an interval.
inline constexpr std::size_t kLeastRoutes = 5;

/// Whether a row of a table shows intervals when its runs cover this many routes.
inline bool showsIntervals(std::size_t routes) { return routes >= kLeastRoutes; }

/// The note under a table in which some rows show no intervals; `clusters`: what the bootstrap
/// draws.
std::string intervalRule(const std::string& clusters = "routes");

/// "20.123 [18.4, 22.0]", of counts "7 / 1.520 km = 4.605 [1.851, 9.488]"; "-" without a value.
std::string estimateText(const PooledEstimate& estimate, int decimals, bool with_interval);

/// " [18.400, 22.000]", or nothing.
std::string intervalText(const std::optional<Interval>& interval, int decimals = 3);

/// "0.012", "< 0.001".
std::string probabilityText(double p);

/// A caveat for the reader: over-dispersed, no distances, all routes equal, or no interval although
/// the row's other cells have one; empty when there is none.
std::string estimateNote(const PooledEstimate& estimate, bool with_interval);

/// "1 route", "10 routes".
std::string countText(std::size_t count, const std::string& noun);

/// A warning where there are fewer than kLeastSeeds seeds, or too few clusters (routes, or what
/// else was drawn) for intervals to be meaningful; else empty.
std::string fewWarning(std::size_t seeds, std::size_t clusters, bool routes);

}  // namespace cdiff::evaluation
