// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/comparison/comparison_differences.h"

#include <algorithm>

#include "core/markup.h"
#include "core/text.h"

namespace cdiff::evaluation {
namespace {

/// By name, with the values of both sides.
using DifferencesByName = std::map<std::string, Difference>;

void note(const std::string& name, const std::string& a, const std::string& b,
          DifferencesByName& found) {
  Difference& difference = found[name];
  difference.name = name;
  difference.a.insert(a);
  difference.b.insert(b);
  difference.pairs += a != b;
}

/// Value under a key, or nothing.
std::string valueOf(const std::map<std::string, std::string>& values, const std::string& key) {
  const auto found = values.find(key);
  return found == values.end() ? "" : found->second;
}

/// The levels of a factor in a group of runs, which are averaged: "constant and pdm_lite".
std::string levelsIn(const std::vector<const RunRecord*>& runs, const std::string& factor) {
  std::set<std::string> levels;
  for (const RunRecord* run : runs) levels.insert(run->factors.at(factor));
  return core::joinText({levels.begin(), levels.end()}, " and ");
}

void noteFactors(const RunPair& pair, DifferencesByName& found) {
  for (const std::string& factor : factorNames())
    note(factor, levelsIn(pair.a, factor), levelsIn(pair.b, factor), found);
}

/// Whether two values name files of one name: their contents are compared, not their folders.
bool sameFileName(const std::string& a, const std::string& b) {
  const std::size_t slash_a = a.rfind('/');
  const std::size_t slash_b = b.rfind('/');
  return slash_a != std::string::npos && slash_b != std::string::npos &&
         a.substr(slash_a) == b.substr(slash_b);
}

/// Keys of either scenario, but for the factors, which have a list of their own.
void noteSettings(const Settings& a, const Settings& b, DifferencesByName& found) {
  std::set<std::string> keys;
  for (const auto& [key, value] : a) keys.insert(key);
  for (const auto& [key, value] : b) keys.insert(key);
  for (const std::string& factor : factorNames()) keys.erase(factor);
  for (const std::string& key : keys) {
    const std::string value_a = valueOf(a, key);
    const std::string value_b = valueOf(b, key);
    if (!sameFileName(value_a, value_b)) note(key, value_a, value_b, found);
  }
}

void noteFiles(const RunPair& pair, std::set<std::string>& files) {
  const InputHashes& a = pair.a.front()->inputs;
  const InputHashes& b = pair.b.front()->inputs;
  if (a.empty() || b.empty()) return;  // recorded by a version that kept no hashes
  for (const auto& [name, hash] : a) {
    if (valueOf(b, name) != hash) files.insert(name);
  }
  for (const auto& [name, hash] : b) {
    if (a.count(name) == 0) files.insert(name);
  }
}

bool sameScenario(const RunPair& pair) {
  return pair.a.front()->factors.at("scenario") == pair.b.front()->factors.at("scenario");
}

std::string unquoted(const std::string& value) {
  const bool quoted = value.size() > 1 && value.front() == '"' && value.back() == '"';
  return quoted ? value.substr(1, value.size() - 2) : value;
}

std::string valuesText(const std::set<std::string>& values) {
  constexpr std::size_t kShown = 3;
  constexpr std::size_t kLetters = 40;
  if (values.size() > kShown) return std::to_string(values.size()) + " values";
  std::vector<std::string> shown;
  for (const std::string& value : values) {
    const std::string text = unquoted(value);
    shown.push_back(text.empty() ? "(none)" : core::cutText(text, kLetters));
  }
  return core::joinText(shown, ", ");
}

std::string textOf(const Difference& difference, std::size_t pairs) {
  return difference.name + " (A " + valuesText(difference.a) + ", B " + valuesText(difference.b) +
         (difference.pairs < pairs ? ", in " + std::to_string(difference.pairs) + " of " +
                                         std::to_string(pairs) + " pairs"
                                   : "") +
         ")";
}

std::string listText(const std::vector<Difference>& differences, std::size_t pairs) {
  constexpr std::size_t kShown = 12;
  std::vector<std::string> shown;
  for (const Difference& difference : differences) {
    if (shown.size() < kShown) shown.push_back(textOf(difference, pairs));
  }
  const std::size_t more = differences.size() - shown.size();
  return core::joinText(shown, ", ") +
         (more == 0 ? "" : " and " + std::to_string(more) + " more (scenario.yaml of the runs)");
}

}  // namespace

Differences differencesOf(const std::vector<RunPair>& pairs, const BatchConditions& a,
                          const BatchConditions& b) {
  DifferencesByName factors;
  DifferencesByName settings;
  Differences differences;
  for (const RunPair& pair : pairs) {
    noteFactors(pair, factors);
    if (!sameScenario(pair)) continue;
    noteFiles(pair, differences.files);
    const auto settings_a = a.settings.find(pair.a.front()->id);
    const auto settings_b = b.settings.find(pair.b.front()->id);
    const bool known = settings_a != a.settings.end() && settings_b != b.settings.end();
    if (known) noteSettings(*settings_a->second, *settings_b->second, settings);
    differences.known = differences.known && known;
  }
  for (const std::string& factor : factorNames()) {
    if (factors[factor].pairs > 0) differences.factors.push_back(factors[factor]);
  }
  for (const auto& [key, difference] : settings) {
    if (difference.pairs > 0) differences.settings.push_back(difference);
  }
  return differences;
}

std::string differencesText(const Differences& differences, std::size_t pairs) {
  std::vector<std::string> parts;
  if (!differences.factors.empty()) parts.push_back(listText(differences.factors, pairs));
  if (!differences.settings.empty())
    parts.push_back((differences.settings.size() == 1 ? "key " : "keys ") +
                    listText(differences.settings, pairs));
  if (!differences.files.empty())
    parts.push_back((differences.files.size() == 1 ? "file " : "files ") +
                    core::joinText({differences.files.begin(), differences.files.end()}, ", "));
  if (!parts.empty()) return core::joinText(parts, "; ");
  return differences.known ? "no factor, key or file" : "no factor; their scenarios were not read";
}

}  // namespace cdiff::evaluation
