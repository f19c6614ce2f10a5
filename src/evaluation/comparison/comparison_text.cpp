// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/comparison/comparison_text.h"

#include <algorithm>
#include <cmath>

#include "core/csv.h"
#include "core/markup.h"
#include "core/text.h"
#include "evaluation/comparison/comparison.h"
#include "evaluation/comparison/comparison_differences.h"
#include "evaluation/intervals/intervals.h"
#include "evaluation/intervals/pooled_estimate.h"
#include "metrics/metric_registry.h"

namespace cdiff::evaluation {
namespace {

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

/// "10 routes", "3 seeds".
std::string clustersText(const Comparison& comparison) {
  const bool routes = comparison.cluster == "scenario";
  return countText(comparison.clusters, routes ? "route" : comparison.cluster.c_str()) +
         (comparison.cluster == "seed" ? "" : " x " + countText(comparison.seeds, "seed"));
}

std::string headOf(const Comparison& comparison) {
  std::string text =
      "## A = " + core::markdownText(comparison.a) + ", B = " + core::markdownText(comparison.b) +
      "\n\n" + countText(comparison.pairs, "pair") + " of " + countText(comparison.runs_a, "run") +
      " of A and " + std::to_string(comparison.runs_b) + " of B: " + clustersText(comparison) +
      "; paired by " +
      core::joinText({comparison.paired_by.begin(), comparison.paired_by.end()}, ", ") +
      followersText(comparison) + ".\n";
  text += "\nA and B differ in: " +
          core::markdownText(differencesText(comparison.differences, comparison.pairs)) + ".\n";
  if (!comparison.conditions.empty())
    text += "\nConditions: " + core::markdownText(comparison.conditions) + ".\n";
  const std::string warning =
      fewWarning(comparison.seeds, comparison.clusters, comparison.cluster == "scenario");
  return text + (warning.empty() ? "" : "\nWarning: " + warning + "\n");
}

/// "1.90 [0.68, 5.34]": rate of B / rate of A.
std::string ratioText(const MeasureComparison& measure, bool with_interval) {
  if (!measure.rates || !std::isfinite(measure.rates->ratio)) return "-";
  if (!with_interval) return core::formatFixed(measure.rates->ratio, 2);
  const Interval& interval = measure.rates->interval;
  return core::formatFixed(measure.rates->ratio, 2) + " [" + core::formatFixed(interval.low, 2) +
         ", " + (std::isfinite(interval.high) ? core::formatFixed(interval.high, 2) : "inf") + "]";
}

/// Caveats for the reader about one row.
std::string noteOf(const MeasureComparison& measure, bool with_intervals) {
  std::vector<std::string> notes;
  for (const auto& [side, estimate] : {std::pair{"A", &measure.a}, std::pair{"B", &measure.b}}) {
    const std::string note = estimateNote(*estimate, with_intervals);
    if (!note.empty()) notes.push_back(std::string(side) + ": " + note);
  }
  if (with_intervals && measure.interval_kind == IntervalKind::kUnseen)
    notes.push_back("B - A is the same on all routes: interval by unseen routes");
  return core::joinText(notes, "; ");
}

std::string rowOf(const MeasureComparison& measure, bool intervals) {
  const std::string difference = measure.difference
                                     ? core::formatFixed(*measure.difference, 3) +
                                           (intervals ? intervalText(measure.interval) : "")
                                     : "-";
  return "| " +
         core::joinText({core::markdownText(measure.measure), std::to_string(measure.pairs),
                         metrics::toText(measure.a.kind), estimateText(measure.a, 3, intervals),
                         estimateText(measure.b, 3, intervals), difference,
                         ratioText(measure, intervals), probabilityText(measure.p),
                         probabilityText(measure.p_holm), noteOf(measure, intervals)},
                        " | ") +
         " |\n";
}

/// The rows of one family; nothing without any.
std::string tableOf(const Comparison& comparison, bool headline) {
  std::string rows;
  const bool intervals = showsIntervals(comparison.clusters);
  for (const MeasureComparison& measure : comparison.measures) {
    if (measure.headline == headline) rows += rowOf(measure, intervals);
  }
  if (rows.empty()) return rows;
  const std::string range = intervals ? " [95 %] | " : " | ";
  std::string text = "\n| measure | pairs | kind | A" + range + "B" + range + "B - A" + range +
                     "B / A" + range +
                     "p | p (Holm) | note |\n|---|---|---|---|---|---|---|---|---|---|\n";
  text += rows;
  const std::string drawn = comparison.cluster == "scenario" ? "route" : comparison.cluster;
  return intervals ? text : text + "\n" + intervalRule(drawn + "s") + "\n";
}

/// Where no p of a mean can be small enough to stay.
std::string nothingCanStay(const std::vector<Comparison>& comparisons, const Multiplicity& number) {
  std::size_t routes = 0;
  for (const Comparison& comparison : comparisons) routes = std::max(routes, comparison.clusters);
  const double least = leastExchangeP(routes);
  if (routes == 0 || least * static_cast<double>(number.differences) <= 0.05) return "";
  return "With " + countText(routes, "route") + " no p of a mean is below " +
         core::formatNumber(least) +
         ", so of so many differences of means none can stay; name the "
         "ones to test (--figure).\n";
}

/// Of one family; nothing where it is empty.
std::string multiplicityText(const std::vector<Comparison>& comparisons, bool headline) {
  const Multiplicity number = multiplicityOf(comparisons, headline);
  if (number.differences == 0) return "";
  return "\nMultiplicity: of " + countText(number.differences, "difference") + " tested here, " +
         std::to_string(number.apart) + " have p <= 0.05, where about " +
         core::formatFixed(0.05 * static_cast<double>(number.differences), 1) +
         " would by chance if A and B were the same; " +
         std::to_string(number.apart_by_holm.size()) +
         " stay after Holm's correction for their number" +
         (number.apart_by_holm.empty() ? "" : ": " + core::joinText(number.apart_by_holm, ", ")) +
         ".\n" + nothingCanStay(comparisons, number);
}

bool hasHeadlines(const std::vector<Comparison>& comparisons) {
  return multiplicityOf(comparisons, true).differences > 0;
}

/// A table for each comparison, and what stays of one family.
std::string familyText(const std::vector<Comparison>& comparisons, bool headline) {
  std::string text;
  for (const Comparison& comparison : comparisons)
    text += (text.empty() ? "" : "\n") + headOf(comparison) + tableOf(comparison, headline);
  return text + multiplicityText(comparisons, headline);
}

std::vector<std::string> intervalCells(const std::optional<Interval>& interval) {
  if (!interval) return {"", ""};
  return {core::csvNumber(interval->low), core::csvNumber(interval->high)};
}

void append(std::vector<std::string>& cells, const std::vector<std::string>& others) {
  cells.insert(cells.end(), others.begin(), others.end());
}

/// Value, interval and how it was made, events, exposure, dispersion, interval by routes.
std::vector<std::string> sideCells(const PooledEstimate& estimate) {
  std::vector<std::string> cells = {core::csvNumber(estimate.value)};
  append(cells, intervalCells(estimate.interval));
  cells.push_back(toText(estimate.interval_kind));
  if (!estimate.counts()) {
    append(cells, std::vector<std::string>(5));
    return cells;
  }
  append(cells, {std::to_string(estimate.events), core::csvNumber(estimate.exposure),
                 core::csvNumber(estimate.dispersion)});
  append(cells, intervalCells(estimate.clustered));
  return cells;
}

std::string csvLine(const Comparison& comparison, const MeasureComparison& measure) {
  std::vector<std::string> cells = {comparison.a,
                                    comparison.b,
                                    measure.measure,
                                    metrics::toText(measure.a.kind),
                                    std::to_string(measure.pairs),
                                    std::to_string(measure.a.routes),
                                    std::to_string(comparison.seeds)};
  append(cells, sideCells(measure.a));
  append(cells, sideCells(measure.b));
  cells.push_back(core::csvNumber(measure.difference));
  append(cells, intervalCells(measure.interval));
  cells.push_back(toText(measure.interval_kind));
  const bool ratio = measure.rates && std::isfinite(measure.rates->ratio);
  cells.push_back(ratio ? core::csvNumber(measure.rates->ratio) : "");
  append(cells, intervalCells(ratio ? std::make_optional(measure.rates->interval) : std::nullopt));
  append(cells, {core::csvNumber(measure.p_exchange), core::csvNumber(measure.p),
                 core::csvNumber(measure.p_holm), measure.headline ? "headline" : "other"});
  return core::csvRow(cells);
}

}  // namespace

std::string comparisonMarkdown(const std::vector<Comparison>& comparisons, bool all) {
  if (comparisons.empty()) return "";
  if (!hasHeadlines(comparisons)) return familyText(comparisons, false);
  const std::string text = familyText(comparisons, true);
  const std::size_t others = multiplicityOf(comparisons, false).differences;
  if (others == 0) return text;
  if (!all)
    return text + "\n" + countText(others, "further difference") +
           ": --all shows them, the CSV file holds them.\n";
  return text + "\n# All other measures\n\n" + familyText(comparisons, false);
}

std::string comparisonCsv(const std::vector<Comparison>& comparisons) {
  std::vector<std::string> head = {"a", "b", "figure", "kind", "pairs", "routes", "seeds"};
  for (const char* side : {"_a", "_b"}) {
    for (const char* column : {"value", "low", "high", "interval", "events", "exposure",
                               "dispersion", "routes_low", "routes_high"})
      head.push_back(std::string(column) + side);
  }
  append(head, {"difference", "low_95", "high_95", "interval", "ratio", "ratio_low", "ratio_high",
                "p_exchange", "p", "p_holm", "family"});
  std::string text = core::csvRow(head);
  for (const Comparison& comparison : comparisons) {
    for (const MeasureComparison& measure : comparison.measures)
      text += csvLine(comparison, measure);
  }
  return text;
}

}  // namespace cdiff::evaluation
