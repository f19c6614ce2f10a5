// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/worker.h"

#include <chrono>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <thread>

#include "core/file.h"
#include "core/folder_lock.h"
#include "core/markup.h"
#include "core/output_folder.h"
#include "core/process_pool.h"
#include "core/program.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "session/scenario_options.h"

namespace cdiff::evaluation {
namespace {

namespace fs = std::filesystem;
using core::ExitCode;

constexpr const char* kPlanAgain =
    "; plan it again with the command that planned it (cdiff evaluate: with --resume)";
/// Between two looks at the runs that other workers have.
constexpr std::chrono::milliseconds kLookPeriod{200};

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

/// What the run's summary says; only a fault where it cannot be read, nothing where there is none.
SummaryFacts factsIn(const fs::path& folder) {
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

/// Takes the end of a run without a summary, whose process says that all went well.
void describeWithoutSummary(RunRecord& record, const std::string& fault, const fs::path& folder) {
  const RunCommand& command = record.command;
  const bool is_there =
      !command.isSession() && (command.result.empty() || core::isFile(folder / command.result));
  record.status = is_there ? "completed" : "error";
  if (is_there)
    record.verdict = record::Outcome::kNotJudged;
  else
    record.cause = fault.empty() ? "the run left no " + command.result : core::plainText(fault);
}

/// Status, cause and measures of a run that has ended.
void describeEnd(RunRecord& record, const core::ProcessEnd& end, const fs::path& folder,
                 double timeout) {
  record.cause.clear();
  record.status = "error";
  if (end.timed_out) {
    record.cause = "timed out: killed after " + core::formatNumber(timeout) + " s";
    return;
  }
  const SummaryFacts facts = record.command.isSession() ? factsIn(folder) : SummaryFacts();
  if (record.exit_code == ExitCode::kInterrupted || end.interrupted) record.status = "interrupted";
  const bool judged = record.command.isSession() && record.exit_code == ExitCode::kVerdictFailed;
  if (record.exit_code != ExitCode::kPassed && !judged) {
    if (record.failed())
      record.cause = core::plainText(causeOf(record.exit_code, facts.fault, folder / "log.txt"));
    return;
  }
  if (facts.status.empty()) return describeWithoutSummary(record, facts.fault, folder);
  record.status = facts.status;
  record.verdict = facts.verdict;
  record.reasons = facts.reasons;
  record.decided_by = facts.decided_by;
  record.simulated_seconds = facts.simulated_seconds;
  record.measures = facts.measures;
}

/// Where the next folder of a run is made, so that it is in its place whole.
fs::path nextFolder(const fs::path& results, const std::string& id) {
  return results / kLeftBehindFolder / (".next." + id);
}

/// Gives a run a new folder with its scenario and its record, and moves the one that a silent host
/// has, whose session may still write into it, to kLeftBehindFolder. False where the lease was lost
/// meanwhile.
bool setAside(const fs::path& results, const std::string& id, const core::Lease& lease) {
  const fs::path old = runFolder(results, id);
  core::OutputFolder aside(core::OutputFolder(results).subfolder(kLeftBehindFolder));
  core::OutputFolder next(aside.subfolder(nextFolder(results, id).filename().string()));
  next.write("scenario.yaml", core::readFile(old / "scenario.yaml", "scenario"));
  next.write(kRecordFile, core::readFile(old / kRecordFile, "record"));
  std::string name = id;
  for (int i = 2; fs::exists(aside.path() / name); ++i) name = id + "." + std::to_string(i);
  const fs::path place = aside.subfolder(name);
  if (!lease.isHeld()) return false;
  fs::rename(old, place);
  fs::rename(next.path(), old);
  return true;
}

/// Whether a run's folder may be written by a session of another host: that of the lease before
/// ours, of a take-over that was cut off, or the one that its lock names.
bool isAnotherHosts(const fs::path& results, const std::string& id, const core::Lease& lease) {
  return lease.isFromAnotherHost() || fs::exists(nextFolder(results, id)) ||
         core::FolderLock::isOfAnotherHost(runFolder(results, id));
}

/// Puts the folder into its place that a worker had made which was killed between two renames.
void finishSettingAside(const fs::path& results, const std::string& id) {
  std::error_code none;  // then there is no record, and that is said
  if (!fs::exists(runFolder(results, id)))
    fs::rename(nextFolder(results, id), runFolder(results, id), none);
}

/// Arguments of the program, with the folders in the place of their names.
std::vector<std::string> wordsFor(const RunCommand& command, const fs::path& results,
                                  const fs::path& run) {
  const std::pair<std::string, fs::path> folders[] = {{"{run}", run}, {"{results}", results}};
  std::vector<std::string> words = command.words;
  for (std::string& word : words) {
    for (const auto& [name, folder] : folders) {
      if (word.rfind(name, 0) != 0) continue;
      word = folder.string() + word.substr(name.size());
      break;
    }
  }
  return words;
}

/// A record that is missing, damaged or another run's.
class BadRecord : public core::InputError {
 public:
  using InputError::InputError;
};

/// Runs are addressed by their place in the list of ids.
class Worker {
 public:
  Worker(const std::vector<std::string>& ids, const WorkerOptions& options,
         const std::atomic<bool>& stop)
      : ids_(ids),
        options_(options),
        stop_(stop),
        leases_(leaseFolder(options.results), options.lease) {}

  void run() {
    std::deque<std::size_t> queue;
    for (std::size_t i = 0; i < ids_.size(); ++i) queue.push_back(i);
    std::optional<core::PoolServer> server;
    if (!options_.server.empty()) server = {options_.program, options_.server};
    for (;;) {
      core::runProcesses(queue, {options_.jobs, options_.timeout, options_.grace}, stop_,
                         {[this](std::size_t index) { return start(index); },
                          [this](const core::ProcessEnd& end) { return finish(end); }},
                         server);
      queue = std::move(taken_);
      taken_.clear();
      if (queue.empty() || stop_ || !options_.waits) return;
      std::this_thread::sleep_for(kLookPeriod);
    }
  }

 private:
  struct Held {
    std::shared_ptr<const core::Lease> lease;
    RunRecord record;
  };

  fs::path folderOf(std::size_t index) const { return runFolder(options_.results, ids_[index]); }

  RunRecord recordAt(std::size_t index) const {
    const fs::path file = folderOf(index) / kRecordFile;
    std::optional<RunRecord> record;
    try {
      record = readRecord(file);
    } catch (const core::InputError& error) {
      throw BadRecord(error.what());
    }
    if (!record)
      throw BadRecord("'" + file.string() + "' is missing, but the run is planned" + kPlanAgain);
    if (record->id == ids_[index]) return *record;
    throw BadRecord("'" + file.string() + "' is the record of run '" + core::shortened(record->id) +
                    "'" + kPlanAgain);
  }
  /// Whether it needs nothing any more; then it is announced.
  bool isDone(const RunRecord& record) const {
    if (record.status == "not_run" || record.status == "interrupted") return false;
    if (options_.ended) options_.ended(record);
    return true;
  }

  std::optional<core::ProcessJob> start(std::size_t index) {
    if (held_.count(index) == 0 ? !claim(index) : isLost(index)) return std::nullopt;
    const fs::path folder = folderOf(index);
    core::OutputFolder output(folder);
    RunRecord& record = held_.at(index).record;
    output.remove({record.command.result, "log.txt"});
    output.removeUnfinished();
    ++record.attempts;
    return core::ProcessJob{options_.program, wordsFor(record.command, options_.results, folder),
                            output.claim("log.txt")};
  }

  /// Whether another worker has taken over a run between two of its attempts here.
  bool isLost(std::size_t index) {
    if (held_.at(index).lease->isHeld()) return false;
    held_.erase(index);
    taken_.push_back(index);
    return true;
  }

  /// Whether its record says that nothing is to be done, before we hold the lease: the worker that
  /// holds it may be moving the run's folder.
  bool looksDone(std::size_t index) const {
    std::optional<RunRecord> seen;
    try {
      seen = recordAt(index);
    } catch (const core::InputError&) {
      return false;
    }
    return isDone(*seen);
  }

  /// Its folder may be gone; then the lease would make another one in its place.
  void requireResults() const {
    if (core::isFolder(options_.results / "runs")) return;
    throw core::InputError("'" + options_.results.string() +
                           "' was moved or removed while its runs were under way; go on with it "
                           "where it is now");
  }

  /// A run whose lease or record nobody can use is named, and the others go on.
  bool refuse(std::size_t index, const core::InputError& error) const {
    requireResults();
    RunRecord record;
    record.id = ids_[index];
    record.status = "error";
    record.cause = core::plainText(error.what());
    record.exit_code = ExitCode::kBadInput;
    if (options_.ended) options_.ended(record);
    return false;
  }

  /// Whether the run is ours to do now. What another worker has waits in `taken_`.
  bool claim(std::size_t index) {
    requireResults();
    if (looksDone(index)) return false;
    try {
      return claimReadable(index);
    } catch (const core::UnreadableLease& error) {
      return refuse(index, error);
    }
  }

  bool claimReadable(std::size_t index) {
    std::shared_ptr<const core::Lease> lease = leases_.claim(ids_[index]);
    if (!lease) {
      taken_.push_back(index);
      return false;
    }
    finishSettingAside(options_.results, ids_[index]);
    try {
      const RunRecord record = recordAt(index);  // as it is now that nobody else writes it
      return !isDone(record) && take(index, std::move(lease), record);
    } catch (const BadRecord& error) {
      return refuse(index, error);
    }
  }

  /// Makes a run's folder ours.
  bool take(std::size_t index, std::shared_ptr<const core::Lease> lease, const RunRecord& record) {
    if (!isAnotherHosts(options_.results, ids_[index], *lease)) {
      core::FolderLock::removeLeftBehind(folderOf(index));  // of a session that was killed
    } else if (!setAside(options_.results, ids_[index], *lease)) {
      taken_.push_back(index);
      return false;
    }
    RunRecord next = recordOf(
        {record.id, record.factors, "", record.scenario_sha256, record.inputs, record.command});
    if (options_.compares_inputs && refusesInputs(index, next)) return false;
    held_[index] = {std::move(lease), std::move(next)};
    return true;
  }

  /// Whether the run's scenario or files are not what was planned. Then its record says so, and
  /// the other runs go on.
  bool refusesInputs(std::size_t index, RunRecord& record) {
    record.cause = core::plainText(changedText(folderOf(index) / "scenario.yaml", record));
    if (record.cause.empty()) return false;
    record.status = "error";
    record.exit_code = ExitCode::kBadInput;
    core::writeOwnFile(folderOf(index) / kRecordFile, recordJson(record));
    if (options_.ended) options_.ended(record);
    return true;
  }

  /// What differs from what was planned; empty where nothing does.
  std::string changedText(const fs::path& file, const RunRecord& record) {
    const std::string again = kPlanAgain;
    try {
      const std::string text = core::readFile(file, "scenario");
      if (core::sha256(text) != record.scenario_sha256)
        return "'" + file.string() + "' is not what was planned" + again;
      const auto now = hasher_.hashes(session::loadScenario(file.string()));
      const std::string changed = changedInputs(record.inputs, now);
      if (changed.empty()) return "";
      return "it was planned with other files: " + changed +
             " changed; expected the same on every host" + again;
    } catch (const std::exception& error) {
      return std::string(error.what()) + again;
    }
  }

  /// Takes the end of an attempt; returns whether the run gets another.
  bool finish(const core::ProcessEnd& end) {
    Held& held = held_.at(end.job);
    RunRecord& record = held.record;
    record.exit_code = end.exit_code;
    record.wall_seconds = end.seconds;
    describeEnd(record, end, folderOf(end.job), options_.timeout);
    const bool died = end.exit_code == ExitCode::kRunTimeError || end.exit_code > ExitCode::kSignal;
    const bool ours = held.lease->isHeld();
    const bool again = record.failed() && died && !end.timed_out && !stop_;
    if (ours && again && record.attempts <= options_.retries) return true;
    if (ours) {
      core::writeOwnFile(folderOf(end.job) / kRecordFile, recordJson(record));
      if (options_.ended) options_.ended(record);
    } else {
      taken_.push_back(end.job);
    }
    held_.erase(end.job);
    return false;
  }

  const std::vector<std::string>& ids_;
  const WorkerOptions& options_;
  const std::atomic<bool>& stop_;
  core::LeaseFolder leases_;
  InputHasher hasher_;
  std::map<std::size_t, Held> held_;
  std::deque<std::size_t> taken_;  ///< runs that others have
};

}  // namespace

fs::path leaseFolder(const fs::path& results) { return results / ".leases"; }

fs::path runFolder(const fs::path& results, const std::string& id) { return results / "runs" / id; }

void runPlanned(const std::vector<std::string>& ids, const WorkerOptions& options,
                const std::atomic<bool>& stop) {
  Worker(ids, options, stop).run();
}

}  // namespace cdiff::evaluation
