// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/search/search_proposal.h"

#include <algorithm>
#include <cmath>

namespace cdiff::evaluation {
namespace {

// Elements of a case's draws; those of its keys follow, kDrawsOfKey each.
constexpr std::uint32_t kFreshDraw = 0;
constexpr std::uint32_t kFirstParent = 1;
constexpr std::uint32_t kSecondParent = 2;
constexpr std::uint32_t kForcedKey = 3;
constexpr std::uint32_t kFirstOfKeys = 4;
constexpr std::uint32_t kDrawsOfKey = 4;

enum class KeyDraw : std::uint32_t { kPlace, kParent, kChange, kStep };

std::uint32_t elementOf(std::size_t key, KeyDraw draw) {
  return kFirstOfKeys + kDrawsOfKey * static_cast<std::uint32_t>(key) +
         static_cast<std::uint32_t>(draw);
}

/// Back into [0, 1), mirrored at the bound that was crossed.
double reflected(double place) {
  double folded = std::fmod(std::abs(place), 2.0);
  if (folded >= 1.0) folded = 2.0 - folded;
  return std::min(folded, std::nextafter(1.0, 0.0));
}

/// Places in `rated` of the cases with the highest scores; of equal ones the earlier first.
std::vector<std::size_t> worstOfRated(const std::vector<RatedPoint>& rated, std::size_t most) {
  std::vector<std::size_t> order(rated.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t left, std::size_t right) {
    return rated[left].score > rated[right].score;
  });
  order.resize(std::min(most, order.size()));
  return order;
}

}  // namespace

SearchPoint SearchProposal::drawn(const core::RandomKey& key) const {
  SearchPoint point;
  for (std::size_t i = 0; i < space_.keys().size(); ++i)
    point.push_back(stream_.uniform(key, elementOf(i, KeyDraw::kPlace)));
  return point;
}

double SearchProposal::changed(const core::RandomKey& key, std::size_t index, double place) const {
  if (!space_.keys()[index].levels.empty())
    return stream_.uniform(key, elementOf(index, KeyDraw::kPlace));
  return reflected(place + options_.step * stream_.normal(key, elementOf(index, KeyDraw::kStep)));
}

SearchPoint SearchProposal::bred(const core::RandomKey& key,
                                 const std::vector<RatedPoint>& rated) const {
  const auto elite = worstOfRated(rated, static_cast<std::size_t>(options_.elite));
  const auto parent = [&](std::uint32_t draw) -> const SearchPoint& {
    return rated[elite[stream_.index(key, draw, elite.size())]].point;
  };
  const SearchPoint& first = parent(kFirstParent);
  const SearchPoint& second = parent(kSecondParent);
  const std::size_t forced = stream_.index(key, kForcedKey, first.size());
  SearchPoint point;
  for (std::size_t i = 0; i < first.size(); ++i) {
    const bool other = stream_.uniform(key, elementOf(i, KeyDraw::kParent)) < 0.5;
    const double place = other ? second[i] : first[i];
    const bool change =
        i == forced || stream_.uniform(key, elementOf(i, KeyDraw::kChange)) < options_.change;
    point.push_back(change ? changed(key, i, place) : place);
  }
  return point;
}

SearchPoint SearchProposal::point(std::size_t number, const std::vector<RatedPoint>& rated,
                                  std::size_t attempt) const {
  core::RandomKey key;
  key.decision = static_cast<std::uint32_t>(number);
  key.diffusion_step = static_cast<std::uint16_t>(attempt);
  const bool drawn_now = options_.method == "random" || rated.empty() ||
                         number < static_cast<std::size_t>(options_.draws) ||
                         stream_.uniform(key, kFreshDraw) < options_.fresh;
  return drawn_now ? drawn(key) : bred(key, rated);
}

}  // namespace cdiff::evaluation
