// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/search/search.h"

#include <algorithm>

#include "core/file.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "evaluation/worker.h"
#include "planners/registry.h"

namespace cdiff::evaluation {
namespace {

namespace fs = std::filesystem;

constexpr const char* kCarefulEnd = "_careful";

std::string caseId(std::size_t number) {
  constexpr std::size_t kDigits = 4;
  const std::string digits = std::to_string(number + 1);
  return "case_" + std::string(kDigits - std::min(kDigits, digits.size()), '0') + digits;
}

std::string carefulPlanner() { return planners::plannerTitled("Careful driver"); }

/// "NAME key=value ..." in words.
std::vector<std::string> egoWords(const std::string& ego) {
  std::vector<std::string> words = core::splitText(ego, ' ');
  if (!words.empty() && words.front().find('=') != std::string::npos)
    throw core::InputError("--ego '" + core::shortened(ego) +
                           "': expected the name of a planner first, as 'NAME key=value'");
  return words;
}

SearchScore scoreIn(const RunRecord& record, const fs::path& results) {
  if (!record.complete()) return {};
  const fs::path file = runFolder(results, record.id) / "summary.json";
  return searchScoreOf(record, contactsIn(core::readFile(file, "summary"), file.string()));
}

/// Why the scenario does not take these values together; empty where it does.
std::string refusalOf(const SearchRequest& request, const std::vector<std::string>& set) {
  session::SessionRequest session = sessionRequestOf(request);
  session.set.insert(session.set.end(), set.begin(), set.end());
  session.set_source = request.options_source;
  try {
    session::resolveRequest(session);
  } catch (const core::InputError& error) {
    return error.what();
  }
  return "";
}

bool haveEnded(const std::vector<RunRecord>& records) {
  return std::all_of(records.begin(), records.end(),
                     [](const RunRecord& record) { return record.complete() || record.failed(); });
}

}  // namespace

session::SessionRequest sessionRequestOf(const SearchRequest& request) {
  session::SessionRequest session;
  session.scenario = request.scenario;
  session.mode = request.mode;
  session.cbv_planner = request.cbv_planner;
  session.set = request.set;
  const std::vector<std::string> ego = egoWords(request.ego);
  if (!ego.empty()) {
    session.ego_planner = ego.front();
    session.set.insert(session.set.end(), ego.begin() + 1, ego.end());
  }
  return session;
}

Search::Search(const SearchRequest& request)
    : request_(request),
      space_(request.options, sessionRequestOf(request), request.options_source),
      proposal_(request_.options, space_, request.seed),
      asks_careful_(session::resolveRequest(sessionRequestOf(request)).fiercestMode() ==
                    "challenging") {}

bool Search::isThere(const std::vector<std::string>& set,
                     const std::vector<SearchCase>& others) const {
  const auto same = [&](const SearchCase& other) { return other.set == set; };
  return std::any_of(cases_.begin(), cases_.end(), same) ||
         std::any_of(others.begin(), others.end(), same);
}

/// A proposal that was there before, or whose values the scenario refuses together, is replaced by
/// another one. False where the space seems to have no other. Throws InputError where the scenario
/// refuses all.
bool Search::propose(std::size_t number, const std::vector<RatedPoint>& rated,
                     const std::vector<SearchCase>& others, SearchCase& next) const {
  constexpr std::size_t kMostAttempts = 200;
  bool allowed = false;
  std::string refused;
  for (std::size_t attempt = 0; attempt < kMostAttempts; ++attempt) {
    next.point = proposal_.point(number, rated, attempt);
    next.set = space_.assignments(next.point);
    const bool known = isThere(next.set, others);
    const std::string error = known ? "" : refusalOf(request_, next.set);
    if (!known && error.empty()) return true;
    if (error.empty())
      allowed = true;
    else
      refused = error;
  }
  if (allowed || refused.empty() || !cases_.empty()) return false;
  throw core::InputError(request_.options_source + ": the scenario refuses each of " +
                         std::to_string(kMostAttempts) +
                         " cases, though it takes the values one by one: " + refused);
}

std::vector<SearchCase> Search::proposed() const {
  std::vector<RatedPoint> rated;
  for (const SearchCase& earlier : cases_) rated.push_back({earlier.point, earlier.worth()});
  const std::size_t end =
      std::min(request_.budget, cases_.size() + static_cast<std::size_t>(request_.options.batch));
  std::vector<SearchCase> batch;
  for (std::size_t number = cases_.size(); number < end; ++number) {
    SearchCase next;
    next.id = caseId(number);
    if (!propose(number, rated, batch, next)) break;
    batch.push_back(next);
  }
  return batch;
}

std::vector<PlannedRun> Search::planned(const std::vector<SearchCase>& batch, bool careful) const {
  const session::SessionRequest session = sessionRequestOf(request_);
  MatrixOptions matrix;
  matrix.scenarios = {session.scenario};
  if (!session.mode.empty()) matrix.modes = {session.mode};
  if (!session.ego_planner.empty()) matrix.ego_planners = {session.ego_planner};
  if (!session.cbv_planner.empty()) matrix.cbv_planners = {session.cbv_planner};
  matrix.set = session.set;
  std::vector<std::string> ids;
  for (const SearchCase& one : batch) {
    ids.push_back(one.id + (careful ? kCarefulEnd : ""));
    matrix.variants.push_back(ids.back() + ": " + core::joinText(one.set, " "));
    if (careful) matrix.variants.back() += " ego_planner=" + carefulPlanner();
  }
  std::vector<PlannedRun> runs = planRuns(matrix, request_.options_source);
  for (std::size_t i = 0; i < runs.size(); ++i) runs[i].id = ids[i];
  return runs;
}

/// Whether all of its sessions ended.
bool Search::askCarefulDriver(std::vector<SearchCase>& batch, const fs::path& results,
                              const Runner& run) const {
  std::vector<SearchCase> hit;
  for (const SearchCase& one : batch) {
    if (one.score.isFound()) hit.push_back(one);
  }
  if (hit.empty()) return true;
  const std::vector<RunRecord> records = run(planned(hit, true));
  if (!haveEnded(records)) return false;
  auto record = records.begin();
  for (SearchCase& one : batch) {
    if (!one.score.isFound()) continue;
    one.careful_broke = record->failed();
    if (!one.careful_broke) one.careful_survives = !scoreIn(*record, results).isFound();
    ++record;
  }
  return true;
}

bool Search::advance(const fs::path& results, const Runner& run) {
  std::vector<SearchCase> batch = proposed();
  if (batch.empty()) return false;
  const std::vector<RunRecord> records = run(planned(batch, false));
  if (!haveEnded(records)) return false;
  for (std::size_t i = 0; i < batch.size(); ++i) {
    batch[i].record = records.at(i);
    batch[i].score = scoreIn(records[i], results);
  }
  if (asks_careful_ && !askCarefulDriver(batch, results, run)) return false;
  cases_.insert(cases_.end(), batch.begin(), batch.end());
  return true;
}

std::vector<const SearchCase*> worstFirst(const std::vector<SearchCase>& cases) {
  std::vector<const SearchCase*> order;
  for (const SearchCase& one : cases) order.push_back(&one);
  std::stable_sort(order.begin(), order.end(), [](const SearchCase* left, const SearchCase* right) {
    return left->worth() > right->worth();
  });
  return order;
}

}  // namespace cdiff::evaluation
