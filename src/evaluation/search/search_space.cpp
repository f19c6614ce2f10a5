// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/search/search_space.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <set>

#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::evaluation {
namespace {

using core::InputError;

constexpr double kRangeSteps = 1000.0;

[[noreturn]] void refuseKey(const std::string& text, const std::string& source) {
  throw InputError(source + ": '" + core::shortened(text) +
                   "' is no key of a search; expected \"key: low .. high\" with numbers and low "
                   "below high, or \"key: a | b\" with two levels or more, none twice");
}

bool isWholeText(const std::string& text) { return text.find_first_of(".eE") == std::string::npos; }

/// Of "key: a | b | c" in words; empty where these are no levels, or one is there twice.
std::vector<std::string> levelsOf(const std::vector<std::string>& words) {
  std::vector<std::string> levels;
  for (std::size_t i = 1; i < words.size(); ++i) {
    const bool bar = words[i] == "|";
    if (bar != (i % 2 == 0)) return {};
    if (!bar) levels.push_back(words[i]);
  }
  const std::set<std::string> distinct(levels.begin(), levels.end());
  const bool ended = words.size() % 2 == 0;
  return ended && distinct.size() == levels.size() ? levels : std::vector<std::string>();
}

/// Whether the key decides anything in a scenario: generated demand has no departure times, and
/// a demand file no density.
bool acts(const std::string& key, const session::ScenarioOptions& scenario) {
  const bool generated = scenario.demand == "generated";
  if (key.rfind("traffic.", 0) == 0) return generated;
  return key != "begin_time" || (!generated && scenario.demand != "none");
}

/// A whole number with all of its digits.
std::string wholeText(double value) { return std::to_string(std::llround(value)); }

/// Resolves the scenario with the ends of the range, or with every level.
void requireAllowed(const SearchKey& key, session::SessionRequest request,
                    const std::string& source) {
  std::vector<std::string> values = key.levels;
  if (values.empty()) {
    const auto text = [&](double end) {
      return key.whole ? wholeText(end) : core::formatNumber(end);
    };
    values = {text(key.low), text(key.high)};
  }
  request.set_source = source;
  for (const std::string& value : values) {
    session::SessionRequest varied = request;
    varied.set.push_back(key.key + "=" + value);
    session::resolveRequest(varied);
  }
}

}  // namespace

std::string SearchKey::valueAt(double place) const {
  if (!levels.empty())
    return levels[static_cast<std::size_t>(place * static_cast<double>(levels.size()))];
  if (whole) return wholeText(low + std::floor(place * (high - low + 1.0)));
  const double share = std::floor(place * (kRangeSteps + 1.0)) / kRangeSteps;
  // Steps of a range are no decimals of few digits in binary; nine digits give them back.
  char text[32];
  std::snprintf(text, sizeof(text), "%.9g", low + share * (high - low));
  return text;
}

SearchKey searchKeyOf(const std::string& text, const std::string& source) {
  const std::vector<std::string> words = core::splitText(text, ' ');
  if (words.size() < 4 || words[0].size() < 2 || words[0].back() != ':') refuseKey(text, source);
  SearchKey key;
  key.key = words[0].substr(0, words[0].size() - 1);
  if (words[2] != "..") {
    key.levels = levelsOf(words);
    if (key.levels.empty()) refuseKey(text, source);
    return key;
  }
  const auto low = core::parseNumber(words[1]);
  const auto high = core::parseNumber(words[3]);
  if (words.size() != 4 || !low || !high || !(*low < *high)) refuseKey(text, source);
  key.low = *low;
  key.high = *high;
  key.whole = isWholeText(words[1]) && isWholeText(words[3]);
  return key;
}

SearchSpace::SearchSpace(const SearchOptions& options, const session::SessionRequest& request,
                         const std::string& source) {
  const session::ScenarioOptions scenario = session::resolveRequest(request);
  std::vector<std::string> texts = options.keys;
  if (scenario.fiercestMode() != "naturalistic")
    texts.insert(texts.end(), options.attack_keys.begin(), options.attack_keys.end());
  std::set<std::string> seen;
  for (const std::string& text : texts) {
    const SearchKey key = searchKeyOf(text, source);
    if (!seen.insert(key.key).second)
      throw InputError(source + ": key '" + key.key + "' is there twice; expected it once");
    if (!acts(key.key, scenario)) {
      left_out_.push_back(key.key);
      continue;
    }
    requireAllowed(key, request, source + ", '" + text + "'");
    keys_.push_back(key);
  }
  if (keys_.empty())
    throw InputError(source + ": no key is left that acts in this scenario; expected one or more");
}

double SearchSpace::size() const {
  double size = 1.0;
  for (const SearchKey& key : keys_) {
    if (!key.levels.empty())
      size *= static_cast<double>(key.levels.size());
    else
      size *= key.whole ? key.high - key.low + 1.0 : kRangeSteps + 1.0;
  }
  return size;
}

std::vector<std::string> SearchSpace::assignments(const SearchPoint& point) const {
  std::vector<std::string> set;
  for (std::size_t i = 0; i < keys_.size(); ++i)
    set.push_back(keys_[i].key + "=" + keys_[i].valueAt(point.at(i)));
  return set;
}

}  // namespace cdiff::evaluation
