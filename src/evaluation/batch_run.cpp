// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/batch_run.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "e2e_cdiff/core/exceptions.h"
#include "evaluation/executor.h"

namespace cdiff::evaluation {
namespace {

using nlohmann::json;

void addNumbers(const json& object, const std::string& place, SummaryNumbers& numbers) {
  for (const auto& [key, value] : object.items()) {
    if (value.is_object()) addNumbers(value, place + "/" + key, numbers);
    if (value.is_number()) numbers[place + "/" + key] = value;
  }
}

}  // namespace

SummaryNumbers summaryNumbers(const std::string& text, const std::string& source) {
  const json summary = json::parse(text, nullptr, false);
  if (!summary.is_object()) {
    throw core::InputError("'" + source +
                           "' is no summary of a session; delete the folder's "
                           "record.json to have the run repeated");
  }
  SummaryNumbers numbers;
  addNumbers(summary, "", numbers);
  return numbers;
}

std::optional<double> BatchRun::number(const std::string& pointer) const {
  const auto found = numbers.find(pointer);
  return found == numbers.end() ? std::nullopt : std::optional<double>(found->second);
}

std::vector<BatchRun> readBatchRuns(const std::filesystem::path& results) {
  std::vector<BatchRun> runs;
  for (RunRecord& record : readRecords(results)) {
    BatchRun run;
    run.folder = runFolder(results, record.id);
    const auto file = run.folder / "summary.json";
    if (record.complete())
      run.numbers = summaryNumbers(core::readFile(file, "summary"), file.string());
    run.record = std::move(record);
    runs.push_back(std::move(run));
  }
  return runs;
}

bool hasLevels(const RunRecord& record, const Factors& levels) {
  return std::all_of(levels.begin(), levels.end(), [&](const auto& level) {
    const auto own = record.factors.find(level.first);
    return own != record.factors.end() && own->second == level.second;
  });
}

std::vector<const BatchRun*> runsWith(const std::vector<BatchRun>& runs, const Factors& levels) {
  std::vector<const BatchRun*> found;
  for (const BatchRun& run : runs) {
    if (hasLevels(run.record, levels)) found.push_back(&run);
  }
  return found;
}

}  // namespace cdiff::evaluation
