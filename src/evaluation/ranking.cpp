// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/ranking.h"

#include <algorithm>

#include "core/text.h"
#include "evaluation/comparison/comparison.h"
#include "metrics/known_measures.h"

namespace cdiff::evaluation {
namespace {

constexpr double kLargestP = 0.05;  // of a difference that is called one

/// Contacts of CBVs with the ego over the km as CBV; empty where none was driven.
PooledEstimate contactsOf(const System& system) {
  const auto found = system.measures.find(metrics::known::kCbvEgoCollisions.name);
  return found == system.measures.end() ? PooledEstimate() : found->second;
}

/// Contacts per km; -1 where no CBV was driven.
double rateOf(const System& system) { return contactsOf(system).value.value_or(-1.0); }

RunSet runsOf(const System& system, const std::vector<RunRecord>& records) {
  RunSet set;
  for (const RunRecord& record : records) {
    if (systemFactors(record.factors) == system.factors) set.records.push_back(record);
  }
  return set;
}

/// Whether contacts of two systems differ by chance; 1 without a pair of runs.
double probabilityOf(const RunSet& first, const RunSet& other) {
  const Comparison comparison = compareRuns(first, other, {"scenario", "seed", "repetition"},
                                            {metrics::known::kCbvEgoCollisions.name});
  return comparison.measures.empty() ? 1.0 : comparison.measures.front().p;
}

void compareFirst(const std::vector<RunRecord>& records, const SystemNames& names,
                  Ranking& ranking) {
  const RunSet first = runsOf(ranking.systems.front(), records);
  std::vector<double> p;
  std::vector<std::string> others;
  for (std::size_t i = 1; i < ranking.systems.size(); ++i) {
    if (rateOf(ranking.systems[i]) < 0.0) continue;
    p.push_back(probabilityOf(first, runsOf(ranking.systems[i], records)));
    others.push_back(names.of(ranking.systems[i].factors));
  }
  const std::vector<double> adjusted = holmAdjusted(p);
  for (std::size_t i = 0; i < adjusted.size(); ++i) {
    if (adjusted[i] > kLargestP)
      ranking.not_apart.push_back(others[i]);
    else
      ranking.largest_p = std::max(ranking.largest_p, adjusted[i]);
  }
}

/// "18 times in 0.94 km (19.2 per km, 95 % [11.4, 30.3])".
std::string contactsText(const System& system) {
  const PooledEstimate contacts = contactsOf(system);
  if (!contacts.value) return "drove no CBV";
  return std::to_string(contacts.events) + (contacts.events == 1 ? " time in " : " times in ") +
         core::formatFixed(contacts.exposure, 2) + (contacts.per_km ? " km (" : " runs (") +
         core::formatFixed(*contacts.value, 1) + (contacts.per_km ? " per km" : " per run") +
         (contacts.interval ? ", 95 %" + intervalText(contacts.interval, 1) : "") + ")";
}

/// Whether the first is apart from the others.
std::string apartText(const Ranking& ranking, std::size_t others) {
  const auto& not_apart = ranking.not_apart;
  if (others == 0) return "";
  const std::string p = probabilityText(std::max(ranking.largest_p, 0.0005));
  const std::string beyond = ", beyond chance (p " + std::string(p.front() == '<' ? p : "<= " + p) +
                             " after Holm's correction).";
  if (not_apart.empty())
    return "The first has more than " + std::string(others == 1 ? "the other" : "all others") +
           beyond;
  const std::string open = "Not shown to be harder than " + core::joinText(not_apart, ", ") + ".";
  return not_apart.size() == others ? open : open + " It has more than the rest" + beyond;
}

/// The others, after the first.
std::string rankedText(const Ranking& ranking, const SystemNames& names) {
  constexpr std::size_t kFirst = 3;
  const auto& systems = ranking.systems;
  std::vector<std::string> parts;
  for (std::size_t i = 1; i < systems.size(); ++i) {
    if (i >= kFirst && i + 1 < systems.size()) continue;
    if (i > kFirst) parts.push_back(std::to_string(i - kFirst) + " more between");
    parts.push_back(names.of(systems[i].factors) + " " + contactsText(systems[i]));
  }
  return core::joinText(parts, "; ");
}

}  // namespace

Ranking rankingOf(const std::vector<System>& systems, const std::vector<RunRecord>& records,
                  const SystemNames& names) {
  Ranking ranking;
  for (const System& system : systems) {
    if (system.routes > 0) ranking.systems.push_back(system);
  }
  std::stable_sort(
      ranking.systems.begin(), ranking.systems.end(),
      [](const System& left, const System& right) { return rateOf(left) > rateOf(right); });
  if (ranking.systems.size() > 1 && rateOf(ranking.systems.front()) >= 0.0)
    compareFirst(records, names, ranking);
  return ranking;
}

std::vector<std::string> rankingSentences(const Ranking& ranking, const SystemNames& names) {
  if (ranking.systems.empty()) return {"No run is complete."};
  const System& first = ranking.systems.front();
  if (rateOf(first) < 0.0) return {"No CBV was driven, so nothing ranks the runs."};
  const std::string name = names.of(first.factors);
  const std::string touched = "CBVs touched the ego " + contactsText(first) + ".";
  if (ranking.systems.size() == 1) return {name + ": " + touched};
  const bool none = contactsOf(first).events == 0;
  const std::string lead = names.egosDiffer() ? "Most contacts: " : "Hardest for the ego: ";
  std::vector<std::string> sentences = {
      none ? "No CBV touched the ego; " + name + ": " + contactsText(first) + "."
           : lead + name + ". Its " + touched,
      "Then " + rankedText(ranking, names) + "."};
  const auto driven = std::count_if(ranking.systems.begin(), ranking.systems.end(),
                                    [](const System& system) { return rateOf(system) >= 0.0; });
  const std::string apart = apartText(ranking, static_cast<std::size_t>(driven) - 1);
  if (!none && !apart.empty()) sentences.push_back(apart);
  return sentences;
}

}  // namespace cdiff::evaluation
