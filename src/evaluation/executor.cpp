// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/executor.h"

#include <algorithm>
#include <set>

#include "core/output_folder.h"
#include "e2e_cdiff/core/exceptions.h"
#include "evaluation/plan_file.h"
#include "evaluation/run_order.h"

namespace cdiff::evaluation {

namespace fs = std::filesystem;

void Executor::announce() {
  if (options_.resume) refuseRenamed();
  for (std::size_t i = 0; i < plan_.size(); ++i) enqueue(i);
  orderQueue(now_);
  informCaller();
  for (const std::size_t index : now_) {
    core::OutputFolder::requireFree(folderOf(index), {kRecordFile, "scenario.yaml", "log.txt"});
    queue_.push_back(plan_[index].id);
  }
  writeRecords();
  writePlan(options_.results, {programSha256(), instructionSets(), options_.timeout,
                               options_.retries, options_.server.empty(), queue_});
}

void Executor::join() {
  queue_ = readPlan(options_.results).ids;
  for (std::size_t i = 0; i < plan_.size(); ++i) {
    records_.push_back(recordOf(plan_[i]));
    now_.push_back(i);
  }
}

/// A run that an earlier version called otherwise would count twice.
void Executor::refuseRenamed() const {
  std::map<Factors, std::string> ids;
  std::set<std::string> planned_ids;
  for (const PlannedRun& run : plan_) {
    ids[run.factors] = run.id;
    planned_ids.insert(run.id);
  }
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(options_.results / "runs", none)) {
    const auto record = readRecord(entry.path() / kRecordFile);
    const auto planned = record ? ids.find(record->factors) : ids.end();
    if (planned == ids.end() || planned_ids.count(record->id) != 0) continue;
    throw core::InputError("'" + entry.path().string() + "' holds the run that is called '" +
                           planned->second +
                           "' now; give another --results, or begin again where the command has "
                           "--overwrite");
  }
}

fs::path Executor::folderOf(std::size_t index) const {
  return runFolder(options_.results, plan_[index].id);
}

/// Gives the run a record, and puts it in line unless its earlier result stands.
void Executor::enqueue(std::size_t index) {
  records_.push_back(recordOf(plan_[index]));
  if (options_.resume && staysOrIsCounted(index)) return;
  (isChosen(index) ? now_ : later_).push_back(index);
}

void Executor::orderQueue(std::deque<std::size_t>& queue) const {
  const std::vector<std::size_t> order = runOrder(plan_);
  std::vector<std::size_t> places(plan_.size());
  for (std::size_t i = 0; i < order.size(); ++i) places[order[i]] = i;
  std::sort(queue.begin(), queue.end(),
            [&](std::size_t left, std::size_t right) { return places[left] < places[right]; });
}

bool Executor::isChosen(std::size_t index) const {
  return !options_.chosen || options_.chosen(plan_[index]);
}

/// Whether the result of an earlier batch stands; else, of a chosen run, the cause to run it again
/// is counted.
bool Executor::staysOrIsCounted(std::size_t index) {
  const auto earlier = readRecord(folderOf(index) / kRecordFile);
  if (!earlier) return false;
  std::string cause = causeToRepeat(*earlier, plan_[index]);
  const std::string& result = plan_[index].command.result;
  std::vector<std::string> needed;
  if (!result.empty()) needed.push_back(result);
  if (plan_[index].command.isSession()) needed.emplace_back("trace.csv");
  for (const std::string& file : needed) {
    if (cause.empty() && !fs::is_regular_file(folderOf(index) / file)) cause = file + " missing";
  }
  if (!cause.empty()) {
    if (isChosen(index))
      repeated_[cause].push_back(plan_[index].id);
    else if (earlier->complete() && isOfAnotherScenario(*earlier, plan_[index]))
      stale_.insert(index);  // it must not count
    else
      records_.back() = *earlier;
    return false;
  }
  core::OutputFolder(folderOf(index)).removeUnfinished();  // of a batch that was killed there
  records_.back() = *earlier;
  resumed_.push_back(index);
  return true;
}

void Executor::informCaller() const {
  for (const auto& [cause, ids] : repeated_) {
    if (options_.repeated) options_.repeated(cause, ids);
  }
  for (const std::size_t index : resumed_) {
    if (options_.kept && isChosen(index)) options_.kept(records_[index]);
  }
}

/// Each run that is still to come gets a record that says so, whatever stops the batch later.
void Executor::writeRecords() const {
  std::deque<std::size_t> missing = now_;
  for (const std::size_t index : later_) {
    if (stale_.count(index) != 0 || !fs::exists(folderOf(index) / kRecordFile))
      missing.push_back(index);
  }
  std::vector<std::string> names;
  for (const std::size_t index : missing) names.push_back(plan_[index].id);
  core::OutputFolder runs(core::OutputFolder(options_.results).subfolder("runs"));
  runs.removeUnfinished();
  runs.makeSubfolders(names);
  for (const std::size_t index : missing) writeRecord(index);
}

void Executor::writeRecord(std::size_t index) const {
  core::OutputFolder folder(folderOf(index));
  folder.write("scenario.yaml", plan_[index].scenario_text);
  folder.write(kRecordFile, recordJson(records_[index]));
}

std::vector<RunRecord> Executor::collect() {
  for (const std::size_t index : now_) {
    const auto ended = ended_.find(plan_[index].id);
    if (ended != ended_.end()) {
      const Factors factors = records_[index].factors;
      records_[index] = ended->second;
      records_[index].factors = factors;  // one without a record has none
    } else if (const auto record = readRecord(folderOf(index) / kRecordFile)) {
      records_[index] = *record;
    }
  }
  return records_;
}

void Executor::close() const {
  core::OutputFolder(options_.results).remove({PlanFile::kName});
  core::LeaseFolder(leaseFolder(options_.results), options_.lease).removeLeftBehind();
}

std::vector<RunRecord> executeRuns(const std::vector<PlannedRun>& plan,
                                   const ExecutorOptions& options, const std::atomic<bool>& stop) {
  Executor executor(plan, options);
  executor.announce();
  WorkerOptions worker = options;
  worker.waits = true;
  worker.ended = [&](const RunRecord& record) {
    executor.take(record);
    if (options.ended) options.ended(record);
  };
  runPlanned(executor.queue(), worker, stop);
  executor.close();
  return executor.collect();
}

}  // namespace cdiff::evaluation
