// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/executor.h"

#include <algorithm>
#include <deque>
#include <map>
#include <optional>
#include <set>

#include "core/file.h"
#include "core/output_folder.h"
#include "core/process_pool.h"
#include "core/program.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "evaluation/run_order.h"

namespace cdiff::evaluation {
namespace {

namespace fs = std::filesystem;
using core::ExitCode;

/// The last line that a run wrote; empty when there is none.
std::string lastLine(const fs::path& log) {
  if (!fs::is_regular_file(log)) return "";
  const auto lines = core::splitText(core::readFile(log, "log"), '\n');
  return lines.empty() ? "" : lines.back();
}

std::string causeOf(int exit_code, const std::string& fault, const fs::path& log) {
  if (!fault.empty()) return fault;
  const std::string line = lastLine(log);
  if (exit_code > ExitCode::kSignal) {
    return "the process ended by signal " + std::to_string(exit_code - ExitCode::kSignal);
  }
  return "exit code " + std::to_string(exit_code) + (line.empty() ? "" : ": " + line);
}

/// One batch of `cdiff evaluate`: what is to run now waits in `queue_`, the rest of the plan keeps
/// its record. Runs, records and folders are addressed by their place in the plan.
class Executor {
 public:
  Executor(const std::vector<PlannedRun>& plan, const ExecutorOptions& options,
           const std::atomic<bool>& stop)
      : plan_(plan), options_(options), stop_(stop) {}

  std::vector<RunRecord> execute() {
    if (options_.resume) refuseRenamed();
    for (std::size_t i = 0; i < plan_.size(); ++i) enqueue(i);
    orderQueue();
    announceRuns();
    std::optional<core::PoolServer> server;
    if (!options_.server.empty()) server = {options_.program, options_.server};
    core::runProcesses(queue_, {options_.jobs, options_.timeout, options_.grace}, stop_,
                       {[this](std::size_t index) { return start(index); },
                        [this](const core::ProcessEnd& end) { return finish(end); }},
                       server);
    return std::move(records_);
  }

 private:
  /// A run that an earlier version called otherwise would count twice.
  void refuseRenamed() const {
    std::map<Factors, std::string> ids;
    std::set<std::string> planned_ids;
    for (const PlannedRun& run : plan_) {
      ids[run.factors] = run.id;
      planned_ids.insert(run.id);
    }
    std::error_code none;
    for (const auto& entry : fs::directory_iterator(options_.results / "runs", none)) {
      const auto record = readRecord(entry.path() / "record.json");
      const auto planned = record ? ids.find(record->factors) : ids.end();
      if (planned == ids.end() || planned_ids.count(record->id) != 0) continue;
      throw core::InputError("'" + entry.path().string() + "' holds the run that is called '" +
                             planned->second +
                             "' by this version; begin the batch again (--overwrite), or give "
                             "another --results");
    }
  }

  fs::path folderOf(std::size_t index) const {
    return runFolder(options_.results, plan_[index].id);
  }

  /// Gives the run a record, and puts it in line unless its earlier result stands.
  void enqueue(std::size_t index) {
    records_.push_back(recordOf(plan_[index]));
    if (options_.resume && staysOrIsCounted(index)) return;
    (isChosen(index) ? queue_ : later_).push_back(index);
  }
  void orderQueue() {
    const std::vector<std::size_t> order = runOrder(plan_);
    std::vector<std::size_t> places(plan_.size());
    for (std::size_t i = 0; i < order.size(); ++i) places[order[i]] = i;
    std::sort(queue_.begin(), queue_.end(),
              [&](std::size_t left, std::size_t right) { return places[left] < places[right]; });
  }
  bool isChosen(std::size_t index) const {
    return !options_.chosen || options_.chosen(plan_[index]);
  }

  /// Whether the result of an earlier batch stands; else, of a chosen run, the cause to run it
  /// again is counted.
  bool staysOrIsCounted(std::size_t index) {
    const auto earlier = readRecord(folderOf(index) / "record.json");
    if (!earlier) return false;
    std::string cause = causeToRepeat(*earlier, plan_[index]);
    if (cause.empty() && !fs::is_regular_file(folderOf(index) / "summary.json"))
      cause = "summary.json missing";
    if (!cause.empty()) {
      if (isChosen(index)) repeated_[cause].push_back(plan_[index].id);
      return false;
    }
    core::OutputFolder(folderOf(index)).removeUnfinished();  // of a batch that was killed there
    records_.back() = *earlier;
    resumed_.push_back(index);
    return true;
  }

  /// Each run that is still to come gets a record that says so, whatever stops the batch later.
  void announceRuns() {
    for (const auto& [cause, ids] : repeated_) {
      if (options_.repeated) options_.repeated(cause, ids);
    }
    for (const std::size_t index : resumed_) {
      if (options_.ended && isChosen(index)) options_.ended(records_[index], true);
    }
    for (const std::size_t index : queue_)
      core::OutputFolder::requireFree(folderOf(index), {"record.json", "scenario.yaml", "log.txt"});
    for (const std::size_t index : queue_) writeRecord(index);
    for (const std::size_t index : later_) {
      if (!fs::exists(folderOf(index) / "record.json")) writeRecord(index);
    }
  }

  void writeRecord(std::size_t index) const {
    core::OutputFolder runs(core::OutputFolder(options_.results).subfolder("runs"));
    core::writeOwnFile(runs.subfolder(plan_[index].id) / "record.json",
                       recordJson(records_[index]));
  }

  core::ProcessJob start(std::size_t index) {
    const fs::path folder = folderOf(index);
    core::OutputFolder output(folder);
    output.remove({"summary.json", "log.txt"});
    output.removeUnfinished();
    output.write("scenario.yaml", plan_[index].scenario_text);
    ++records_[index].attempts;
    return {options_.program,
            {"run", (folder / "scenario.yaml").string(), "--quiet", "--results", folder.string(),
             "--overwrite"},
            output.claim("log.txt")};
  }

  /// Takes the end of an attempt; returns whether the run gets another.
  bool finish(const core::ProcessEnd& end) {
    RunRecord& record = records_[end.job];
    record.exit_code = end.exit_code;
    record.wall_seconds = end.seconds;
    describeEnd(record, end);
    const bool died = end.exit_code == ExitCode::kRunTimeError || end.exit_code > ExitCode::kSignal;
    if (record.failed() && died && !end.timed_out && !stop_ && record.attempts <= options_.retries)
      return true;
    core::writeOwnFile(folderOf(end.job) / "record.json", recordJson(record));
    if (options_.ended) options_.ended(record, false);
    return false;
  }

  /// What the run's summary says; only a fault where it cannot be read, nothing where there is
  /// none.
  static SummaryFacts factsIn(const fs::path& folder) {
    SummaryFacts facts;
    const fs::path file = folder / "summary.json";
    try {
      if (fs::is_regular_file(file))
        facts = readSummary(core::readFile(file, "summary"), file.string());
    } catch (const core::InputError& error) {
      facts.fault = error.what();
    }
    return facts;
  }

  /// Status, cause and measures.
  void describeEnd(RunRecord& record, const core::ProcessEnd& end) const {
    const fs::path folder = folderOf(end.job);
    record.cause.clear();
    record.status = "error";
    if (end.timed_out) {
      record.cause = "timed out: killed after " + core::formatNumber(options_.timeout) + " s";
      return;
    }
    const SummaryFacts facts = factsIn(folder);
    if (record.exit_code == ExitCode::kInterrupted || end.interrupted)
      record.status = "interrupted";
    if (record.exit_code != ExitCode::kPassed && record.exit_code != ExitCode::kVerdictFailed) {
      if (record.failed())
        record.cause = causeOf(record.exit_code, facts.fault, folder / "log.txt");
      return;
    }
    if (facts.status.empty()) {
      record.status = "error";
      record.cause = facts.fault.empty() ? "the run left no summary.json" : facts.fault;
      return;
    }
    record.status = facts.status;
    record.verdict = facts.verdict;
    record.reasons = facts.reasons;
    record.decided_by = facts.decided_by;
    record.simulated_seconds = facts.simulated_seconds;
    record.measures = facts.measures;
  }

  const std::vector<PlannedRun>& plan_;
  const ExecutorOptions& options_;
  const std::atomic<bool>& stop_;
  std::vector<RunRecord> records_;
  std::vector<std::size_t> resumed_;                          ///< runs that were complete already
  std::map<std::string, std::vector<std::string>> repeated_;  ///< ids by cause
  std::deque<std::size_t> queue_;
  std::deque<std::size_t> later_;  ///< not chosen
};

}  // namespace

fs::path runFolder(const fs::path& results, const std::string& id) { return results / "runs" / id; }

std::vector<RunRecord> executeRuns(const std::vector<PlannedRun>& plan,
                                   const ExecutorOptions& options, const std::atomic<bool>& stop) {
  return Executor(plan, options, stop).execute();
}

}  // namespace cdiff::evaluation
