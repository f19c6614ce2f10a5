// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/intervals/intervals.h"

#include <algorithm>
#include <boost/math/special_functions/beta.hpp>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>
#include <limits>
#include <numeric>

#include "e2e_cdiff/core/random.h"
#include "metrics/formulas/quantiles.h"

namespace cdiff::evaluation {

namespace {

/// Odds of a probability; infinite at 1.
double odds(double probability) {
  return probability < 1.0 ? probability / (1.0 - probability)
                           : std::numeric_limits<double>::infinity();
}

/// Two-sided p of a binomial count: twice its smaller tail at `successes`, at most 1.
double binomialP(std::size_t successes, std::size_t trials, double probability) {
  const auto x = static_cast<double>(successes);
  const auto n = static_cast<double>(trials);
  const double at_least = successes == 0 ? 1.0 : boost::math::ibeta(x, n - x + 1.0, probability);
  const double at_most =
      successes == trials ? 1.0 : boost::math::ibetac(x + 1.0, n - x, probability);
  return std::min(1.0, 2.0 * std::min(at_least, at_most));
}

}  // namespace

Interval poissonInterval(std::size_t events) {
  // The quantile of chi-square with 2 a degrees of freedom is twice that of the gamma distribution
  // of shape a.
  const auto x = static_cast<double>(events);
  return {events == 0 ? 0.0 : boost::math::gamma_p_inv(x, kTail),
          boost::math::gamma_q_inv(x + 1.0, kTail)};
}

Interval binomialInterval(std::size_t successes, std::size_t trials) {
  const auto x = static_cast<double>(successes);
  const auto n = static_cast<double>(trials);
  return {successes == 0 ? 0.0 : boost::math::ibeta_inv(x, n - x + 1.0, kTail),
          successes == trials ? 1.0 : boost::math::ibetac_inv(x + 1.0, n - x, kTail)};
}

double largestShareUnseen(std::size_t routes) {
  return 1.0 - std::pow(kTail, 1.0 / static_cast<double>(routes));
}

RateComparison compareRates(std::size_t events_a, double km_a, std::size_t events_b, double km_b) {
  const std::size_t events = events_a + events_b;
  RateComparison result;
  result.ratio = (static_cast<double>(events_b) / km_b) / (static_cast<double>(events_a) / km_a);
  result.interval = {0.0, std::numeric_limits<double>::infinity()};
  if (events == 0) return result;
  result.p = binomialP(events_b, events, km_b / (km_a + km_b));
  const Interval share = binomialInterval(events_b, events);
  result.interval = {odds(share.low) * km_a / km_b, odds(share.high) * km_a / km_b};
  return result;
}

std::vector<double> holmAdjusted(const std::vector<double>& p) {
  std::vector<std::size_t> order(p.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t left, std::size_t right) { return p[left] < p[right]; });
  std::vector<double> adjusted(p.size());
  double largest = 0.0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    largest = std::max(largest, static_cast<double>(p.size() - i) * p[order[i]]);
    adjusted[order[i]] = std::min(1.0, largest);
  }
  return adjusted;
}

namespace {

constexpr std::uint64_t kSeed = 1;
constexpr std::size_t kExhaustiveRoutes = 14;
constexpr std::size_t kDrawnExchanges = 19999;
constexpr double kEqual = 1e-12;  ///< relative; sums taken in another order may differ by this

/// The pooled value of some routes: sum of their sums / sum of their weights.
class Pool {
 public:
  void add(const RouteSum& route) {
    sum_ += route.sum;
    weight_ += route.weight;
  }
  std::optional<double> value() const {
    return weight_ > 0.0 ? std::optional<double>(sum_ / weight_) : std::nullopt;
  }

 private:
  double sum_ = 0.0;
  double weight_ = 0.0;
};

std::optional<double> difference(const std::optional<double>& a, const std::optional<double>& b) {
  return a && b ? std::optional<double>(*b - *a) : std::nullopt;
}

/// Value of B - value of A, with A and B exchanged on the routes for which `exchanged` is true.
template <class Exchanged>
std::optional<double> exchangedDifference(const RouteSums& a, const RouteSums& b,
                                          const Exchanged& exchanged) {
  Pool pool_a;
  Pool pool_b;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const bool other = exchanged(i);
    pool_a.add(other ? b[i] : a[i]);
    pool_b.add(other ? a[i] : b[i]);
  }
  return difference(pool_a.value(), pool_b.value());
}

}  // namespace

std::optional<double> pooledValue(const RouteSums& routes) {
  Pool pool;
  for (const RouteSum& route : routes) pool.add(route);
  return pool.value();
}

std::optional<Interval> RouteBootstrap::valueInterval(const RouteSums& routes) {
  return interval(routes.size(), [&](const std::uint32_t* first) {
    Pool pool;
    for (std::size_t i = 0; i < routes.size(); ++i) pool.add(routes[first[i]]);
    return pool.value();
  });
}

std::optional<Interval> RouteBootstrap::differenceInterval(const RouteSums& a, const RouteSums& b) {
  return interval(a.size(), [&](const std::uint32_t* first) {
    Pool pool_a;
    Pool pool_b;
    for (std::size_t i = 0; i < a.size(); ++i) {
      pool_a.add(a[first[i]]);
      pool_b.add(b[first[i]]);
    }
    return difference(pool_a.value(), pool_b.value());
  });
}

std::optional<Interval> RouteBootstrap::interval(std::size_t routes, const Replicate& replicate) {
  if (routes < 2) return std::nullopt;
  const std::vector<std::uint32_t>& drawn = draws(routes);
  std::vector<double> values;
  values.reserve(kReplicates);
  for (std::size_t i = 0; i < kReplicates; ++i) {
    if (const auto value = replicate(&drawn[i * routes])) values.push_back(*value);
  }
  if (values.empty()) return std::nullopt;
  std::sort(values.begin(), values.end());
  const double spread = values.back() - values.front();
  if (spread <= kEqual * std::max(std::abs(values.front()), std::abs(values.back())))
    return std::nullopt;
  const auto at = [&](double share) {
    return metrics::quantileOf(values, share, metrics::QuantileRule::kLinear);
  };
  const double tail = metrics::expandedTail(routes);
  return Interval{at(tail), at(1.0 - tail)};
}

const std::vector<std::uint32_t>& RouteBootstrap::draws(std::size_t routes) {
  std::vector<std::uint32_t>& drawn = draws_[routes];
  if (!drawn.empty()) return drawn;
  const core::RandomStream stream(kSeed, "route_bootstrap");
  drawn.reserve(kReplicates * routes);
  for (std::uint32_t replicate = 0; replicate < kReplicates; ++replicate) {
    for (std::uint32_t i = 0; i < routes; ++i) {
      drawn.push_back(static_cast<std::uint32_t>(stream.index({0, replicate, 0}, i, routes)));
    }
  }
  return drawn;
}

double exchangeTest(const RouteSums& a, const RouteSums& b) {
  const std::size_t routes = a.size();
  const auto observed = exchangedDifference(a, b, [](std::size_t) { return false; });
  if (!observed) return 1.0;
  const double bound = std::abs(*observed) * (1.0 - kEqual) - kEqual;
  const bool all = routes <= kExhaustiveRoutes;
  const std::size_t patterns = all ? std::size_t{1} << routes : kDrawnExchanges;
  const core::RandomStream stream(kSeed, "route_exchange");
  std::size_t as_large = all ? 0 : 1;  // all patterns include the observed one
  for (std::size_t pattern = 0; pattern < patterns; ++pattern) {
    const core::RandomKey key{0, static_cast<std::uint32_t>(pattern), 0};
    std::uint64_t word = pattern;  // a bit per route; drawn again every 64 routes
    const auto exchanged = [&](std::size_t route) {
      if (!all && route % 64 == 0) word = stream.bits(key, static_cast<std::uint32_t>(route / 64));
      return (word >> route % 64 & 1U) != 0;
    };
    const auto value = exchangedDifference(a, b, exchanged);
    as_large += !value || std::abs(*value) >= bound;
  }
  return static_cast<double>(as_large) / static_cast<double>(all ? patterns : patterns + 1);
}

double leastExchangeP(std::size_t routes) {
  if (routes > kExhaustiveRoutes) return 1.0 / static_cast<double>(kDrawnExchanges + 1);
  return std::ldexp(2.0, -static_cast<int>(routes));
}

}  // namespace cdiff::evaluation
