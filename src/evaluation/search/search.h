// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "evaluation/run_plan.h"
#include "evaluation/search/search_proposal.h"
#include "evaluation/search/search_score.h"

namespace cdiff::evaluation {

/// What is searched: one scenario, one ego, and for how long.
struct SearchRequest {
  std::string scenario;          ///< shipped name or file
  std::string mode;              ///< empty: the scenario's
  std::string ego;               ///< "NAME key=value ..."; empty: the scenario's
  std::string cbv_planner;       ///< empty: the scenario's
  std::vector<std::string> set;  ///< "key=value" each, for every case
  SearchOptions options;
  std::string options_source = "search space";  ///< how the user knows the options, for errors
  std::uint64_t seed = 1;                       ///< of the proposals; the scenario has its own
  std::size_t budget = 0;                       ///< cases
};

/// A case of a search: the scenario with values of the searched keys, and what came of it.
struct SearchCase {
  std::string id;  ///< "case_0001"; the folder of its run
  SearchPoint point;
  std::vector<std::string> set;  ///< "key=value" of each searched key
  RunRecord record;
  SearchScore score;
  /// Whether a careful driver in the ego's place had no contact while it moved; absent where
  /// nobody asked.
  std::optional<bool> careful_survives;

  bool careful_broke = false;  ///< the careful driver was asked, and its session broke

  /// What the search maximizes: the score, or 0 where the careful driver was hit, too, or gave no
  /// answer.
  double worth() const { return isConfirmed() ? score.value : 0.0; }
  bool isFound() const { return score.isFound() && isConfirmed(); }

 private:
  bool isConfirmed() const { return careful_survives.value_or(true) && !careful_broke; }
};

/// Searches a scenario for the sessions that are worst for its ego. In mode challenging a contact
/// counts only where the planner careful_driver, in the ego's place from the start, has none while
/// it moves: that session runs as `ID_careful`. The sessions depend on request and seed alone, so
/// results that are in the folder already may be kept.
class Search {
 public:
  /// Runs planned sessions, whose results lie in `results`/runs/ID then, and gives their records in
  /// the same order.
  using Runner = std::function<std::vector<RunRecord>(const std::vector<PlannedRun>&)>;

  /// Throws InputError for a scenario, an ego or a key that is wrong.
  explicit Search(const SearchRequest& request);
  Search(const Search&) = delete;
  Search& operator=(const Search&) = delete;

  const SearchSpace& space() const { return space_; }
  bool asksCarefulDriver() const { return asks_careful_; }
  /// Plans the next batch, runs it and rates its cases. Gives false, and changes nothing, once the
  /// budget is spent or where a session of the batch was not run or was interrupted.
  bool advance(const std::filesystem::path& results, const Runner& run);
  /// Whether every case of the space is there.
  bool isExhausted() const { return static_cast<double>(cases_.size()) >= space_.size(); }
  /// Those of all batches so far, in their order.
  const std::vector<SearchCase>& cases() const { return cases_; }

 private:
  std::vector<SearchCase> proposed() const;
  bool propose(std::size_t number, const std::vector<RatedPoint>& rated,
               const std::vector<SearchCase>& others, SearchCase& next) const;
  bool isThere(const std::vector<std::string>& set, const std::vector<SearchCase>& others) const;
  std::vector<PlannedRun> planned(const std::vector<SearchCase>& batch, bool careful) const;
  bool askCarefulDriver(std::vector<SearchCase>& batch, const std::filesystem::path& results,
                        const Runner& run) const;

  SearchRequest request_;
  SearchSpace space_;
  SearchProposal proposal_;
  bool asks_careful_;
  std::vector<SearchCase> cases_;
};

/// The cases with the highest worth first; of equal ones the earlier first.
std::vector<const SearchCase*> worstFirst(const std::vector<SearchCase>& cases);

/// The request as scenarios are resolved from it. Throws InputError for an ego without a name.
session::SessionRequest sessionRequestOf(const SearchRequest& request);

}  // namespace cdiff::evaluation
