// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/ranking.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "evaluation/comparison/comparison.h"
#include "metrics/known_measures.h"

namespace cdiff::evaluation {
namespace {

constexpr double kLargestP = 0.05;     // of a difference that is called one
constexpr std::size_t kMostNamed = 6;  // systems in a sentence

PooledEstimate estimateOf(const System& system, const std::string& measure) {
  const auto found = system.measures.find(measure);
  return found == system.measures.end() ? PooledEstimate() : found->second;
}

/// Ranked contacts per km; -1 where no CBV was driven.
double rateOf(const System& system, const std::string& measure) {
  return estimateOf(system, measure).value.value_or(-1.0);
}

/// Contacts with the moving ego, where every system that has contacts of CBVs has them.
std::string rankedMeasure(const std::vector<System>& systems) {
  namespace known = metrics::known;
  const bool told = std::all_of(systems.begin(), systems.end(), [](const System& system) {
    return system.measures.count(known::kCbvMovingEgoCollisions.name) ==
           system.measures.count(known::kCbvEgoCollisions.name);
  });
  return told ? known::kCbvMovingEgoCollisions.name : known::kCbvEgoCollisions.name;
}

bool tellsMotion(const Ranking& ranking) {
  return ranking.measure == metrics::known::kCbvMovingEgoCollisions.name;
}

RunSet runsOf(const System& system, const std::vector<RunRecord>& records) {
  RunSet set;
  for (const RunRecord& record : records) {
    if (systemFactors(record.factors) == system.factors) set.records.push_back(record);
  }
  return set;
}

/// Whether contacts of two systems differ by chance; 1 without a pair of runs, and where they had
/// other inputs, as other traffic.
double probabilityOf(const RunSet& first, const RunSet& other, const std::string& measure) {
  try {
    const Comparison comparison =
        compareRuns(first, other, {"scenario", "seed", "repetition"}, {measure});
    return comparison.measures.empty() ? 1.0 : comparison.measures.front().p;
  } catch (const core::InputError&) {
    return 1.0;
  }
}

void compareFirst(const std::vector<RunRecord>& records, const SystemNames& names,
                  Ranking& ranking) {
  const RunSet first = runsOf(ranking.systems.front(), records);
  std::vector<double> p;
  std::vector<std::string> others;
  for (std::size_t i = 1; i < ranking.systems.size(); ++i) {
    if (rateOf(ranking.systems[i], ranking.measure) < 0.0) continue;
    p.push_back(probabilityOf(first, runsOf(ranking.systems[i], records), ranking.measure));
    others.push_back(names.of(ranking.systems[i].factors));
  }
  // The first was chosen by the same data, so that every pair of systems counts.
  p.resize(others.size() * (others.size() + 1) / 2, 1.0);
  const std::vector<double> adjusted = holmAdjusted(p);
  for (std::size_t i = 0; i < others.size(); ++i) {
    if (adjusted[i] > kLargestP)
      ranking.not_apart.push_back(others[i]);
    else
      ranking.largest_p = std::max(ranking.largest_p, adjusted[i]);
  }
}

/// ", 95 % exact Poisson [11.4, 30.3]": with few routes without the bootstrap's part.
std::string rateIntervalText(const PooledEstimate& contacts) {
  if (!contacts.interval) return "";
  if (!showsIntervals(contacts.routes) || contacts.interval_kind == IntervalKind::kPoisson) {
    return ", 95 % exact Poisson" +
           intervalText(rateInterval(contacts.events, contacts.exposure, std::nullopt), 1);
  }
  return ", 95 % exact Poisson widened by routes" + intervalText(contacts.interval, 1);
}

std::string timesText(std::size_t count) {
  return std::to_string(count) + (count == 1 ? " time" : " times");
}

/// "18 times in 0.94 km (19.2 per km, 95 % exact Poisson [11.4, 30.3]), and 2 times with the ego
/// standing".
std::string contactsText(const System& system, const Ranking& ranking) {
  const PooledEstimate contacts = estimateOf(system, ranking.measure);
  if (!contacts.value) return "drove no CBV";
  const std::string text =
      timesText(contacts.events) + " in " + core::formatFixed(contacts.exposure, 2) +
      (contacts.per_km ? " km (" : " runs (") + core::formatFixed(*contacts.value, 1) +
      (contacts.per_km ? " per km" : " per run") + rateIntervalText(contacts) + ")";
  if (!tellsMotion(ranking)) return text;
  const std::size_t all = estimateOf(system, metrics::known::kCbvEgoCollisions.name).events;
  return text + ", and " + timesText(all - std::min(all, contacts.events)) +
         " with the ego standing";
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
  const std::string whom = not_apart.size() > kMostNamed
                               ? std::to_string(not_apart.size()) + " of the others"
                               : core::joinText(not_apart, ", ");
  const std::string open = "Not shown to be harder than " + whom + ".";
  return not_apart.size() == others ? open : open + " It has more than the rest" + beyond;
}

/// A measure that may order the systems otherwise than contacts of the moving ego.
struct OtherOrder {
  const metrics::MeasureDefinition* measure;
  const char* name;
  double sign;  ///< of the value in how hard a system is: 1 or -1
  int decimals;
};

/// "driving score, lowest first (diffusion 48.0, pdm_lite 66.1)"; empty where it orders the systems
/// as the ranking does.
std::string orderText(const OtherOrder& order, const Ranking& ranking, const SystemNames& names) {
  std::vector<std::pair<double, std::string>> systems;  // minus hardness, then text
  for (const System& system : ranking.systems) {
    const std::optional<double> value = estimateOf(system, order.measure->name).value;
    if (!value || rateOf(system, ranking.measure) < 0.0) continue;
    systems.emplace_back(-order.sign * *value, names.of(system.factors) + " " +
                                                   core::formatFixed(*value, order.decimals));
  }
  const auto harder = [](const auto& left, const auto& right) { return left.first < right.first; };
  if (std::is_sorted(systems.begin(), systems.end(), harder)) return "";
  std::stable_sort(systems.begin(), systems.end(), harder);
  std::vector<std::string> texts;
  for (const auto& [hardness, text] : systems) {
    if (texts.size() < kMostNamed) texts.push_back(text);
  }
  return std::string(order.name) + " (" + core::joinText(texts, ", ") +
         (systems.size() > texts.size() ? ", ..." : "") + ")";
}

/// One sentence; empty where no measure orders the systems otherwise.
std::string otherOrdersText(const Ranking& ranking, const SystemNames& names) {
  namespace known = metrics::known;
  std::vector<std::string> parts;
  for (const OtherOrder& order :
       {OtherOrder{&known::kContactsAtFault, "contacts at the ego's fault per km", 1.0, 1},
        OtherOrder{&known::kDrivingScore, "driving score, lowest first", -1.0, 1}}) {
    const std::string text = orderText(order, ranking, names);
    if (!text.empty()) parts.push_back(text);
  }
  if (parts.empty()) return "";
  return "Other measures order them otherwise: " + core::joinText(parts, "; ") + ".";
}

/// The systems from `begin` on, a text each.
std::vector<std::string> systemTexts(const Ranking& ranking, const SystemNames& names,
                                     std::size_t begin) {
  std::vector<std::string> texts;
  for (std::size_t i = begin; i < ranking.systems.size(); ++i)
    texts.push_back(names.of(ranking.systems[i].factors) + " " +
                    contactsText(ranking.systems[i], ranking));
  return texts;
}

/// " driven by pdm_lite", where one planner drives all egos.
std::string egoText(const Ranking& ranking, const SystemNames& names) {
  return names.egosDiffer() ? ""
                            : " driven by " + ranking.systems.front().factors.at("ego_planner");
}

/// The first sentence, of a batch in which a CBV was driven.
std::string answerText(const Ranking& ranking, const SystemNames& names) {
  const System& first = ranking.systems.front();
  const std::string& name = names.of(first.factors);
  const std::string ego = tellsMotion(ranking) ? "the moving ego" : "the ego";
  const std::string touched = "CBVs touched " + ego + " " + contactsText(first, ranking) + ".";
  if (ranking.systems.size() == 1) {
    return name + (names.egosDiffer() ? ": " : ", for the ego" + egoText(ranking, names) + ": ") +
           touched;
  }
  if (estimateOf(first, ranking.measure).events == 0)
    return "No CBV touched " + ego + egoText(ranking, names) + ": " + name + " " +
           contactsText(first, ranking) + ".";
  const std::string lead =
      names.egosDiffer() ? "Most contacts" : "Hardest for the ego" + egoText(ranking, names);
  return lead + ": " + name + ". Its " + touched;
}

}  // namespace

Ranking rankingOf(const std::vector<System>& systems, const std::vector<RunRecord>& records,
                  const SystemNames& names) {
  Ranking ranking;
  for (const System& system : systems) {
    if (system.routes > 0) ranking.systems.push_back(system);
  }
  ranking.measure = rankedMeasure(ranking.systems);
  const auto rate = [&](const System& system) { return rateOf(system, ranking.measure); };
  std::stable_sort(
      ranking.systems.begin(), ranking.systems.end(),
      [&](const System& left, const System& right) { return rate(left) > rate(right); });
  if (ranking.systems.size() > 1 && rate(ranking.systems.front()) >= 0.0)
    compareFirst(records, names, ranking);
  return ranking;
}

RankingText rankingText(const Ranking& ranking, const SystemNames& names) {
  if (ranking.systems.empty()) return {{"No run is complete."}, {}};
  const auto rate = [&](const System& system) { return rateOf(system, ranking.measure); };
  const System& first = ranking.systems.front();
  if (rate(first) < 0.0) return {{"No CBV was driven, so nothing ranks the runs."}, {}};
  RankingText text{{answerText(ranking, names)}, {}};
  const auto add = [&](const std::string& sentence) {
    if (!sentence.empty()) text.sentences.push_back(sentence);
  };
  std::vector<std::string> others = systemTexts(ranking, names, 1);
  if (others.size() > kMostNamed) {
    add("Then " + std::to_string(others.size()) + " others, listed below.");
    text.folded = std::move(others);
  } else if (!others.empty()) {
    add("Then " + core::joinText(others, "; ") + ".");
  }
  const auto driven = std::count_if(ranking.systems.begin(), ranking.systems.end(),
                                    [&](const System& system) { return rate(system) >= 0.0; });
  if (estimateOf(first, ranking.measure).events > 0)
    add(apartText(ranking, static_cast<std::size_t>(driven) - 1));
  add(otherOrdersText(ranking, names));
  if (!tellsMotion(ranking)) add("These records do not say whether the ego moved.");
  return text;
}

}  // namespace cdiff::evaluation
