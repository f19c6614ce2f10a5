// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "core/spelling.h"

#include <algorithm>
#include <numeric>

namespace cdiff::core {
namespace {

std::size_t editDistance(const std::string& left, const std::string& right) {
  std::vector<std::size_t> row(right.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= left.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= right.size(); ++j) {
      const std::size_t above = row[j];
      const std::size_t change = diagonal + (left[i - 1] == right[j - 1] ? 0 : 1);
      row[j] = std::min({above + 1, row[j - 1] + 1, change});
      diagonal = above;
    }
  }
  return row.back();
}

}  // namespace

std::string nearestName(const std::string& name, const std::vector<std::string>& known) {
  if (known.empty()) return {};
  return *std::min_element(known.begin(), known.end(), [&](const auto& left, const auto& right) {
    return editDistance(name, left) < editDistance(name, right);
  });
}

std::string closeName(const std::string& name, const std::vector<std::string>& known) {
  constexpr std::size_t kLeastPart = 3;  // letters
  const std::string nearest = nearestName(name, known);
  if (3 * editDistance(name, nearest) <= std::max(name.size(), nearest.size())) return nearest;
  if (name.size() < kLeastPart) return {};
  const auto containing = std::find_if(known.begin(), known.end(), [&](const std::string& text) {
    return text.find(name) != std::string::npos;
  });
  return containing == known.end() ? std::string() : *containing;
}

std::string didYouMean(const std::string& name, const std::vector<std::string>& known) {
  const std::string close = closeName(name, known);
  return close.empty() ? close : "; did you mean '" + close + "'?";
}

}  // namespace cdiff::core
