// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>
#include <vector>

#include "evaluation/search/search_options.h"
#include "session/session_request.h"

namespace cdiff::evaluation {

/// A key of the scenario that a search varies: over a range of numbers, or over a few levels.
struct SearchKey {
  std::string key;
  double low = 0.0;
  double high = 0.0;
  bool whole = false;               ///< only whole numbers of the range
  std::vector<std::string> levels;  ///< not empty: these texts instead of the range

  /// The value at a place in [0, 1). A range that is not whole has 1001 values, evenly spaced.
  std::string valueAt(double place) const;
};

/// From "key: low .. high" or "key: a | b". Bounds without a decimal point make whole numbers.
/// `source` names the file in errors. Throws InputError for anything else.
SearchKey searchKeyOf(const std::string& text, const std::string& source);

/// A place of the space: a number in [0, 1) for each of its keys.
using SearchPoint = std::vector<double>;

/// The keys that a search of one scenario varies.
class SearchSpace {
 public:
  /// The keys of the options that the scenario's mode and demand let act; those that do not act go
  /// to leftOut(). Throws InputError naming `source` and the key where one is unknown, is there
  /// twice, has bounds that the scenario does not allow, or none is left.
  SearchSpace(const SearchOptions& options, const session::SessionRequest& request,
              const std::string& source);

  const std::vector<SearchKey>& keys() const { return keys_; }
  const std::vector<std::string>& leftOut() const { return left_out_; }
  /// How many cases there are.
  double size() const;
  /// "key=value" of each key at a place.
  std::vector<std::string> assignments(const SearchPoint& point) const;

 private:
  std::vector<SearchKey> keys_;
  std::vector<std::string> left_out_;
};

}  // namespace cdiff::evaluation
