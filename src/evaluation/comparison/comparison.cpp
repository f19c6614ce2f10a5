// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/comparison/comparison.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "core/markup.h"
#include "core/spelling.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "evaluation/comparison/comparison_differences.h"
#include "evaluation/headline_measures.h"
#include "evaluation/intervals/intervals.h"

namespace cdiff::evaluation {
namespace {

using core::InputError;
using Runs = std::vector<const RunRecord*>;
using Groups = std::map<Factors, Runs>;

/// Factors that say which runs belong together, whatever is compared.
const std::set<std::string> kAlwaysPairs = {"scenario", "seed", "repetition"};

std::set<std::string> levelsOf(const std::vector<RunRecord>& records, const std::string& factor) {
  std::set<std::string> levels;
  for (const RunRecord& record : records) levels.insert(record.factors.at(factor));
  return levels;
}

/// Whether a factor is a function of the other factors but `compared`, as the guidance profile is
/// of mode and method where nothing else sets it.
bool isDetermined(const std::vector<RunRecord>& records, const std::string& factor,
                  const std::string& compared) {
  std::map<Factors, std::string> levels;
  for (const RunRecord& record : records) {
    Factors others = record.factors;
    others.erase(factor);
    others.erase(compared);
    const std::string& level = record.factors.at(factor);
    if (levels.emplace(others, level).first->second != level) return false;
  }
  return true;
}

bool haveCommon(const std::set<std::string>& a, const std::set<std::string>& b) {
  return std::any_of(a.begin(), a.end(),
                     [&](const std::string& each) { return b.count(each) != 0; });
}

/// Complete runs by their levels of the factors that pair.
Groups grouped(const std::vector<RunRecord>& records, const std::set<std::string>& paired_by) {
  Groups groups;
  for (const RunRecord& record : records) {
    if (!record.complete()) continue;
    Factors key;
    for (const std::string& factor : paired_by) key[factor] = record.factors.at(factor);
    groups[key].push_back(&record);
  }
  return groups;
}

/// Mean of a measure over the runs that have it.
std::optional<double> meanOf(const Runs& records, const std::string& measure) {
  RouteSum values;
  for (const RunRecord* record : records) {
    const auto value = record->measures.find(measure);
    if (value == record->measures.end()) continue;
    values.sum += value->second;
    values.weight += 1.0;
  }
  return pooledValue({values});
}

/// Runs of both sides that agree in all that pairs, and have a measure.
class PairedSums {
 public:
  PairedSums(const std::string& measure, const metrics::PoolingRule& rule, bool per_km)
      : measure_(measure),
        mean_of_pairs_(rule.weight == metrics::SessionWeight::kOne),
        a_(measure, rule, per_km),
        b_(measure, rule, per_km) {}

  void add(const Runs& a, const Runs& b, const std::string& cluster) {
    const auto mean_a = meanOf(a, measure_);
    const auto mean_b = meanOf(b, measure_);
    if (!mean_a || !mean_b) return;
    ++pairs_;
    addSide(a, *mean_a, cluster, a_);
    addSide(b, *mean_b, cluster, b_);
  }
  std::size_t pairs() const { return pairs_; }
  const ClusterSums& a() const { return a_; }
  const ClusterSums& b() const { return b_; }
  /// The sums of both sides by the same clusters.
  std::pair<RouteSums, RouteSums> aligned() const {
    std::map<std::string, std::pair<RouteSum, RouteSum>> both;
    for (const auto& [cluster, sum] : a_.byCluster()) both[cluster].first = sum;
    for (const auto& [cluster, sum] : b_.byCluster()) both[cluster].second = sum;
    std::pair<RouteSums, RouteSums> sums;
    for (const auto& [cluster, pair] : both) {
      sums.first.push_back(pair.first);
      sums.second.push_back(pair.second);
    }
    return sums;
  }

 private:
  void addSide(const Runs& runs, double mean, const std::string& cluster, ClusterSums& sums) const {
    if (mean_of_pairs_) {
      sums.addValue(mean, cluster);
      return;
    }
    for (const RunRecord* run : runs) sums.add(*run, cluster);
  }

  std::string measure_;
  bool mean_of_pairs_;
  std::size_t pairs_ = 0;
  ClusterSums a_;
  ClusterSums b_;
};

void addDifference(const PairedSums& sums, const metrics::PoolingRule& rule,
                   RouteBootstrap& bootstrap, MeasureComparison& compared) {
  if (!compared.a.value || !compared.b.value) return;
  compared.difference = *compared.b.value - *compared.a.value;
  const auto [a, b] = sums.aligned();
  compared.interval = bootstrap.differenceInterval(a, b);
  compared.interval_kind = compared.interval ? IntervalKind::kRoutes : IntervalKind::kNone;
  const double range = rule.most - rule.least;
  if (!compared.interval && std::isfinite(range) && a.size() > 1) {
    compared.interval = unseenInterval(*compared.difference, -range, range, a.size());
    compared.interval_kind = IntervalKind::kUnseen;
  }
  compared.p = compared.p_exchange = exchangeTest(a, b);
}

void addRates(MeasureComparison& compared) {
  const PooledEstimate& a = compared.a;
  const PooledEstimate& b = compared.b;
  if (!a.counts() || a.exposure <= 0.0 || b.exposure <= 0.0) return;
  compared.rates = compareRates(a.events, a.exposure, b.events, b.exposure);
  const bool spread = a.over_dispersed || b.over_dispersed;
  compared.p = spread ? std::max(compared.rates->p, compared.p_exchange) : compared.rates->p;
}

/// The comparison, or no pairs where no pair has the measure.
MeasureComparison compareMeasure(const std::string& measure, const std::vector<RunPair>& pairs,
                                 const std::string& cluster, RouteBootstrap& bootstrap) {
  const metrics::PoolingRule rule = poolingOfMeasure(measure);
  const bool per_km = std::all_of(pairs.begin(), pairs.end(), [&](const RunPair& pair) {
    return knowDistances(pair.a, rule, measure) && knowDistances(pair.b, rule, measure);
  });
  PairedSums sums(measure, rule, per_km);
  for (const RunPair& pair : pairs) sums.add(pair.a, pair.b, pair.a.front()->factors.at(cluster));
  MeasureComparison compared;
  compared.measure = measure;
  compared.pairs = sums.pairs();
  if (compared.pairs == 0) return compared;
  compared.a = sums.a().estimate(bootstrap);
  compared.b = sums.b().estimate(bootstrap);
  addDifference(sums, rule, bootstrap, compared);
  addRates(compared);
  return compared;
}

/// All measures.
std::vector<std::string> headlinesFirst() {
  std::vector<std::string> names = headlineMeasures();
  for (const std::string& name : measureNames()) {
    if (!isHeadline(name)) names.push_back(name);
  }
  return names;
}

std::string nearest(const std::string& name, const std::vector<std::string>& known) {
  return "; the nearest is '" + core::nearestName(name, known) +
         "' (all: " + core::joinText(known, ", ") + ")";
}

std::map<std::string, RunSet> setsByLevel(const RunSet& runs, const std::string& factor) {
  std::map<std::string, RunSet> sets;
  for (const RunRecord& record : runs.records) {
    RunSet& set = sets[record.factors.at(factor)];
    set.name = factor + " " + record.factors.at(factor);
    set.records.push_back(record);
    set.conditions = runs.conditions;
  }
  return sets;
}

/// What is drawn: routes where they pair, else seeds, else repetitions.
std::string clusterOf(const std::set<std::string>& paired_by) {
  for (const char* factor : {"scenario", "seed"}) {
    if (paired_by.count(factor) != 0) return factor;
  }
  return "repetition";
}

std::vector<RunPair> pairsOf(const Groups& a, const Groups& b) {
  std::vector<RunPair> pairs;
  for (const auto& [key, runs] : a) {
    const auto partner = b.find(key);
    if (partner != b.end()) pairs.push_back({runs, partner->second});
  }
  return pairs;
}

std::size_t countLevels(const std::vector<RunPair>& pairs, const std::string& factor) {
  std::set<std::string> levels;
  for (const RunPair& pair : pairs) {
    for (const RunRecord* run : pair.a) levels.insert(run->factors.at(factor));
  }
  return levels.size();
}

/// Paired over all factors but `factor` and those that follow it.
Comparison compareLevel(const RunSet& a, const RunSet& b, const std::string& factor,
                        const std::vector<std::string>& names) {
  const Followers followers = followingFactors(a, b, factor);
  std::set<std::string> paired_by(factorNames().begin(), factorNames().end());
  paired_by.erase(factor);
  for (const auto& follower : followers) paired_by.erase(follower.first);
  Comparison comparison = compareRuns(a, b, paired_by, names);
  comparison.followers = followers;
  return comparison;
}

}  // namespace

std::set<std::string> sharedFactors(const RunSet& a, const RunSet& b) {
  std::set<std::string> shared = kAlwaysPairs;
  for (const std::string& factor : factorNames()) {
    if (haveCommon(levelsOf(a.records, factor), levelsOf(b.records, factor))) shared.insert(factor);
  }
  return shared;
}

Followers followingFactors(const RunSet& a, const RunSet& b, const std::string& factor) {
  Followers followers;
  for (const std::string& other : factorNames()) {
    if (other == factor || kAlwaysPairs.count(other) != 0) continue;
    const std::set<std::string> of_a = levelsOf(a.records, other);
    const std::set<std::string> of_b = levelsOf(b.records, other);
    if (haveCommon(of_a, of_b) || !isDetermined(a.records, other, factor) ||
        !isDetermined(b.records, other, factor))
      continue;
    followers[other] = {core::joinText({of_a.begin(), of_a.end()}, ", "),
                        core::joinText({of_b.begin(), of_b.end()}, ", ")};
  }
  return followers;
}

Comparison compareRuns(const RunSet& a, const RunSet& b, const std::set<std::string>& paired_by,
                       const std::vector<std::string>& names) {
  requireComparable(a, b);
  const std::vector<RunPair> pairs =
      pairsOf(grouped(a.records, paired_by), grouped(b.records, paired_by));
  Comparison comparison;
  comparison.a = a.name;
  comparison.b = b.name;
  comparison.paired_by = paired_by;
  comparison.runs_a = a.records.size();
  comparison.runs_b = b.records.size();
  comparison.pairs = pairs.size();
  comparison.differences = differencesOf(pairs, a.conditions, b.conditions);
  comparison.cluster = clusterOf(paired_by);
  comparison.clusters = countLevels(pairs, comparison.cluster);
  comparison.seeds = countLevels(pairs, "seed");
  comparison.conditions = conditionsText(a.conditions, a.records);
  RouteBootstrap bootstrap;
  for (const std::string& measure : names.empty() ? headlinesFirst() : names) {
    MeasureComparison compared = compareMeasure(measure, pairs, comparison.cluster, bootstrap);
    compared.headline = names.empty() && isHeadline(measure);
    if (compared.pairs > 0) comparison.measures.push_back(std::move(compared));
  }
  return comparison;
}

std::vector<Comparison> compareLevels(const RunSet& runs, const std::string& factor,
                                      const std::string& baseline,
                                      const std::vector<std::string>& names) {
  const auto& factors = factorNames();
  if (std::find(factors.begin(), factors.end(), factor) == factors.end())
    throw InputError("--factor '" + factor + "' is no factor" + nearest(factor, factors));
  const std::map<std::string, RunSet> sets = setsByLevel(runs, factor);
  if (sets.count(baseline) == 0) {
    const std::set<std::string> levels = levelsOf(runs.records, factor);
    throw InputError("--baseline '" + baseline + "' is no level of " + factor +
                     nearest(baseline, {levels.begin(), levels.end()}));
  }
  std::vector<Comparison> comparisons;
  for (const auto& [level, set] : sets) {
    if (level != baseline)
      comparisons.push_back(compareLevel(sets.at(baseline), set, factor, names));
  }
  return comparisons;
}

void checkMeasureNames(const std::vector<std::string>& names) {
  const auto& known = measureNames();
  std::set<std::string> given;
  for (const std::string& name : names) {
    if (!given.insert(name).second) throw InputError("--figure '" + name + "' is there twice");
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    throw InputError("--figure '" + name + "' is no measure" + nearest(name, known));
  }
}

void adjustForNumber(std::vector<Comparison>& comparisons) {
  for (const bool headline : {true, false}) {
    std::vector<MeasureComparison*> family;
    for (Comparison& comparison : comparisons) {
      for (MeasureComparison& measure : comparison.measures) {
        if (measure.headline == headline) family.push_back(&measure);
      }
    }
    std::vector<double> p;
    for (const MeasureComparison* measure : family) p.push_back(measure->p);
    const std::vector<double> adjusted = holmAdjusted(p);
    for (std::size_t i = 0; i < family.size(); ++i) family[i]->p_holm = adjusted[i];
  }
}

Multiplicity multiplicityOf(const std::vector<Comparison>& comparisons, bool headline) {
  constexpr double kLargest = 0.05;
  Multiplicity result;
  for (const Comparison& comparison : comparisons) {
    for (const MeasureComparison& measure : comparison.measures) {
      if (measure.headline != headline) continue;
      ++result.differences;
      result.apart += measure.p <= kLargest;
      if (measure.p_holm <= kLargest) result.apart_by_holm.push_back(measure.measure);
    }
  }
  return result;
}

}  // namespace cdiff::evaluation
