// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/executor.h"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <deque>
#include <map>
#include <memory>
#include <thread>

#include "core/exit_code.h"
#include "core/file.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "evaluation/child_process.h"

namespace cdiff::evaluation {
namespace {

namespace fs = std::filesystem;
using core::ExitCode;
using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kPollPeriod{20};

double secondsSince(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

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

/// One attempt under way.
struct Attempt {
  std::size_t index = 0;  ///< of the run
  std::unique_ptr<ChildProcess> process;
  Clock::time_point begin = Clock::now();
  bool timed_out = false;
};

class Executor {
 public:
  Executor(const std::vector<PlannedRun>& plan, const ExecutorOptions& options,
           const std::atomic<bool>& stop)
      : plan_(plan), options_(options), stop_(stop) {}

  std::vector<RunRecord> execute() {
    for (std::size_t i = 0; i < plan_.size(); ++i) enqueue(i);
    announceRuns();
    while (!active_.empty() || (!queue_.empty() && !stop_)) {
      startRuns();
      if (stop_) interruptRuns();
      killLateRuns();
      collectEnded();
      if (!active_.empty()) std::this_thread::sleep_for(kPollPeriod);
    }
    return std::move(records_);
  }

 private:
  fs::path folderOf(std::size_t index) const {
    return runFolder(options_.results, plan_[index].id);
  }

  void enqueue(std::size_t index) {
    records_.push_back(recordOf(plan_[index]));
    if (options_.resume && staysOrIsCounted(index)) return;
    queue_.push_back(index);
  }

  /// Whether the result of an earlier batch stands; else the cause to run it again is counted.
  bool staysOrIsCounted(std::size_t index) {
    const auto earlier = readRecord(folderOf(index) / "record.json");
    if (!earlier) return false;
    std::string cause = causeToRepeat(*earlier, plan_[index]);
    if (cause.empty() && !fs::is_regular_file(folderOf(index) / "summary.json"))
      cause = "summary.json missing";
    if (!cause.empty()) {
      repeated_[cause].push_back(plan_[index].id);
      return false;
    }
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
      if (options_.ended) options_.ended(records_[index], true);
    }
    for (const std::size_t index : queue_) {
      const fs::path folder = folderOf(index);
      std::error_code error;
      fs::create_directories(folder, error);
      if (error) {
        throw core::InputError("cannot make '" + folder.string() + "': " + error.message());
      }
      core::writeFileAtomically(folder / "record.json", recordJson(records_[index]));
    }
  }

  void startRuns() {
    while (!stop_ && !queue_.empty() && static_cast<int>(active_.size()) < options_.jobs) {
      const std::size_t index = queue_.front();
      queue_.pop_front();
      start(index);
    }
  }

  void start(std::size_t index) {
    const fs::path folder = folderOf(index);
    std::error_code ignored;
    fs::remove(folder / "summary.json", ignored);
    core::removeTemporaries(folder);
    core::writeFileAtomically(folder / "scenario.yaml", plan_[index].scenario_text);
    const std::vector<std::string> words = {"run",           (folder / "scenario.yaml").string(),
                                            "--quiet",       "--results",
                                            folder.string(), "--overwrite"};
    ++records_[index].attempts;
    Attempt attempt;
    attempt.index = index;
    attempt.process = std::make_unique<ChildProcess>(options_.program, words, folder / "log.txt");
    active_.push_back(std::move(attempt));
  }

  void killLateRuns() {
    const bool grace_over = interrupted_at_ && secondsSince(*interrupted_at_) > options_.grace;
    for (Attempt& attempt : active_) {
      const bool late = secondsSince(attempt.begin) > options_.timeout;
      if (attempt.timed_out || (!late && !grace_over)) continue;
      attempt.timed_out = late && !grace_over;
      attempt.process->signal(SIGKILL);
    }
  }

  void interruptRuns() {
    if (interrupted_at_) return;
    interrupted_at_ = Clock::now();
    for (const Attempt& attempt : active_) attempt.process->signal(SIGINT);
  }

  void collectEnded() {
    for (std::size_t i = 0; i < active_.size();) {
      const auto exit_code = active_[i].process->poll();
      if (!exit_code) {
        ++i;
        continue;
      }
      const Attempt attempt = std::move(active_[i]);
      active_.erase(active_.begin() + static_cast<std::ptrdiff_t>(i));
      finish(attempt, *exit_code);
    }
  }

  void finish(const Attempt& attempt, int exit_code) {
    RunRecord& record = records_[attempt.index];
    record.exit_code = exit_code;
    record.wall_seconds = secondsSince(attempt.begin);
    describeEnd(record, attempt);
    const bool died = exit_code == ExitCode::kRunTimeError || exit_code > ExitCode::kSignal;
    const bool again = record.failed() && died && !attempt.timed_out && !stop_ &&
                       record.attempts <= options_.retries;
    if (again) {
      queue_.push_front(attempt.index);
      return;
    }
    core::writeFileAtomically(folderOf(attempt.index) / "record.json", recordJson(record));
    if (options_.ended) options_.ended(record, false);
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

  /// Status, cause and figures.
  void describeEnd(RunRecord& record, const Attempt& attempt) const {
    const fs::path folder = folderOf(attempt.index);
    record.cause.clear();
    record.status = "error";
    if (attempt.timed_out) {
      record.cause = "timed out: killed after " + core::formatNumber(options_.timeout) + " s";
      return;
    }
    const SummaryFacts facts = factsIn(folder);
    if (record.exit_code == ExitCode::kInterrupted || interrupted_at_)
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
    record.figures = facts.figures;
  }

  const std::vector<PlannedRun>& plan_;
  const ExecutorOptions& options_;
  const std::atomic<bool>& stop_;
  std::vector<RunRecord> records_;
  std::vector<std::size_t> resumed_;                          ///< runs that were complete already
  std::map<std::string, std::vector<std::string>> repeated_;  ///< ids by cause
  std::deque<std::size_t> queue_;
  std::vector<Attempt> active_;
  std::optional<Clock::time_point> interrupted_at_;
};

}  // namespace

fs::path runFolder(const fs::path& results, const std::string& id) { return results / "runs" / id; }

std::vector<RunRecord> executeRuns(const std::vector<PlannedRun>& plan,
                                   const ExecutorOptions& options, const std::atomic<bool>& stop) {
  return Executor(plan, options, stop).execute();
}

}  // namespace cdiff::evaluation
