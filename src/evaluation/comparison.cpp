// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/comparison.h"

#include <algorithm>
#include <map>
#include <numeric>

#include "core/markup.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::evaluation {
namespace {

using core::InputError;
using Groups = std::map<Factors, std::vector<const RunRecord*>>;

/// Factors that say which runs belong together, whatever is compared.
const std::set<std::string> kAlwaysPairs = {"scenario", "seed", "repetition"};

std::set<std::string> levelsOf(const std::vector<RunRecord>& records, const std::string& factor) {
  std::set<std::string> levels;
  for (const RunRecord& record : records) levels.insert(record.factors.at(factor));
  return levels;
}

/// The one level of a factor that all records have; nullopt where they differ.
std::optional<std::string> onlyLevel(const std::vector<RunRecord>& records,
                                     const std::string& factor) {
  const std::set<std::string> levels = levelsOf(records, factor);
  return levels.size() == 1 ? std::make_optional(*levels.begin()) : std::nullopt;
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
std::optional<double> meanOf(const std::vector<const RunRecord*>& records,
                             const std::string& measure) {
  std::vector<double> values;
  for (const RunRecord* record : records) {
    const auto value = record->measures.find(measure);
    if (value != record->measures.end()) values.push_back(value->second);
  }
  return statisticsOf(values).mean;
}

MeasureComparison compareMeasure(const std::string& measure, const Groups& a, const Groups& b) {
  std::vector<double> values_a;
  std::vector<double> values_b;
  std::vector<double> differences;
  for (const auto& [key, records] : a) {
    const auto partner = b.find(key);
    if (partner == b.end()) continue;
    const auto value_a = meanOf(records, measure);
    const auto value_b = meanOf(partner->second, measure);
    if (!value_a || !value_b) continue;
    values_a.push_back(*value_a);
    values_b.push_back(*value_b);
    differences.push_back(*value_b - *value_a);
  }
  return {measure, statisticsOf(values_a).mean.value_or(0.0),
          statisticsOf(values_b).mean.value_or(0.0), statisticsOf(differences)};
}

std::string nearest(const std::string& name, const std::vector<std::string>& known) {
  return "; the nearest is '" + core::nearestName(name, known) +
         "' (all: " + core::joinText(known, ", ") + ")";
}

std::string intervalText(const Statistics& difference) {
  if (!difference.half_width) return "-";
  return "[" + core::formatFixed(*difference.mean - *difference.half_width, 3) + ", " +
         core::formatFixed(*difference.mean + *difference.half_width, 3) + "]";
}

std::string levelText(const std::string& level) {
  return level.empty() ? "(none)" : core::markdownText(level);
}

/// "; guidance_profile follows (A naturalistic, B safety_critical)".
std::string followersText(const Comparison& comparison) {
  std::string text;
  for (const auto& [factor, levels] : comparison.followers) {
    text += "; " + factor + " follows (A " + levelText(levels.first) + ", B " +
            levelText(levels.second) + ")";
  }
  return text;
}

std::string tableOf(const Comparison& comparison) {
  std::string text =
      "## A = " + core::markdownText(comparison.a) + ", B = " + core::markdownText(comparison.b) +
      "\n\n" + std::to_string(comparison.pairs) + " pairs of " + std::to_string(comparison.runs_a) +
      " runs of A and " + std::to_string(comparison.runs_b) + " of B; paired by " +
      core::joinText({comparison.paired_by.begin(), comparison.paired_by.end()}, ", ") +
      followersText(comparison) +
      ".\n\n| measure | pairs | mean A | mean B | B - A | 95 % interval |\n"
      "|---|---|---|---|---|---|\n";
  for (const MeasureComparison& measure : comparison.measures) {
    text += "| " + core::markdownText(measure.measure) + " | " +
            std::to_string(measure.difference.n) + " | " + core::formatFixed(measure.mean_a, 3) +
            " | " + core::formatFixed(measure.mean_b, 3) + " | " +
            core::formatFixed(*measure.difference.mean, 3) + " | " +
            intervalText(measure.difference) + " |\n";
  }
  return text;
}

std::map<std::string, RunSet> setsByLevel(const std::vector<RunRecord>& records,
                                          const std::string& factor) {
  std::map<std::string, RunSet> sets;
  for (const RunRecord& record : records) {
    RunSet& set = sets[record.factors.at(factor)];
    set.name = factor + " " + record.factors.at(factor);
    set.records.push_back(record);
  }
  return sets;
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
    const std::set<std::string> of_b = levelsOf(b.records, factor);
    for (const std::string& level : levelsOf(a.records, factor)) {
      if (of_b.count(level) != 0) shared.insert(factor);
    }
  }
  return shared;
}

Followers followingFactors(const RunSet& a, const RunSet& b, const std::string& factor) {
  Followers followers;
  for (const std::string& other : factorNames()) {
    if (other == factor || kAlwaysPairs.count(other) != 0) continue;
    const auto level_a = onlyLevel(a.records, other);
    const auto level_b = onlyLevel(b.records, other);
    if (level_a && level_b && *level_a != *level_b) followers[other] = {*level_a, *level_b};
  }
  return followers;
}

Comparison compareRuns(const RunSet& a, const RunSet& b, const std::set<std::string>& paired_by,
                       const std::vector<std::string>& names) {
  const Groups groups_a = grouped(a.records, paired_by);
  const Groups groups_b = grouped(b.records, paired_by);
  Comparison comparison;
  comparison.a = a.name;
  comparison.b = b.name;
  comparison.paired_by = paired_by;
  comparison.runs_a = a.records.size();
  comparison.runs_b = b.records.size();
  for (const auto& [key, records] : groups_a) comparison.pairs += groups_b.count(key);
  for (const std::string& measure : names.empty() ? measureNames() : names) {
    MeasureComparison compared = compareMeasure(measure, groups_a, groups_b);
    if (compared.difference.n > 0) comparison.measures.push_back(compared);
  }
  return comparison;
}

std::vector<Comparison> compareLevels(const std::vector<RunRecord>& records,
                                      const std::string& factor, const std::string& baseline,
                                      const std::vector<std::string>& names) {
  const auto& factors = factorNames();
  if (std::find(factors.begin(), factors.end(), factor) == factors.end())
    throw InputError("--factor '" + factor + "' is no factor" + nearest(factor, factors));
  const std::map<std::string, RunSet> sets = setsByLevel(records, factor);
  if (sets.count(baseline) == 0) {
    const std::set<std::string> levels = levelsOf(records, factor);
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
  for (const std::string& name : names) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    throw InputError("--figure '" + name + "' is no measure" + nearest(name, known));
  }
}

std::string comparisonMarkdown(const std::vector<Comparison>& comparisons) {
  std::string text;
  for (const Comparison& comparison : comparisons)
    text += (text.empty() ? "" : "\n") + tableOf(comparison);
  return text;
}

std::string comparisonCsv(const std::vector<Comparison>& comparisons) {
  std::string text =
      "a,b,figure,pairs,mean_a,mean_b,difference,standard_deviation,low_95,high_95\n";
  const auto field = [](const std::optional<double>& value) {
    return "," + (value ? core::formatNumber(*value) : std::string());
  };
  for (const Comparison& comparison : comparisons) {
    for (const MeasureComparison& measure : comparison.measures) {
      const Statistics& difference = measure.difference;
      text += core::csvCell(comparison.a) + "," + core::csvCell(comparison.b) + "," +
              core::csvCell(measure.measure) + "," + std::to_string(difference.n) +
              field(measure.mean_a) + field(measure.mean_b) + field(difference.mean) +
              field(difference.standard_deviation);
      const bool interval = difference.half_width.has_value();
      text += interval ? field(*difference.mean - *difference.half_width) +
                             field(*difference.mean + *difference.half_width)
                       : ",,";
      text += "\n";
    }
  }
  return text;
}

}  // namespace cdiff::evaluation
