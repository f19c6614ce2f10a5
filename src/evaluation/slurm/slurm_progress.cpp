// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/slurm/slurm_progress.h"

#include <algorithm>
#include <chrono>
#include <deque>
#include <optional>
#include <thread>

#include "evaluation/slurm/slurm_queue.h"
#include "evaluation/worker.h"

namespace cdiff::evaluation {
namespace {

/// Records that one look reads while tasks are queued.
constexpr std::size_t kRecordsALook = 2000;
/// Looks at an empty queue before what has no record counts as not run.
constexpr int kLastLooks = 3;

class JobWatch {
 public:
  JobWatch(const std::vector<std::string>& ids, const SlurmWait& wait,
           const std::atomic<bool>& stop)
      : open_(ids.begin(), ids.end()), wait_(wait), stop_(stop) {}

  std::vector<std::string> run() {
    int empty_looks = 0;
    while (!stop_) {
      readRecords(kRecordsALook);
      if (open_.empty()) break;
      if (isQueueEmpty()) {
        readRecords(open_.size());
        if (open_.empty() || ++empty_looks == kLastLooks) break;
      } else {
        empty_looks = 0;
      }
      pause();
    }
    return {open_.begin(), open_.end()};
  }

 private:
  /// Those that have no result go behind the others.
  void readRecords(std::size_t most) {
    for (std::size_t left = std::min(most, open_.size()); left > 0; --left) {
      const std::string id = open_.front();
      open_.pop_front();
      const auto record = readRecord(runFolder(wait_.results, id) / kRecordFile);
      if (!record || record->status == "not_run" || record->status == "interrupted") {
        open_.push_back(id);
      } else if (wait_.ended) {
        wait_.ended(*record);
      }
    }
  }

  bool isQueueEmpty() {
    const std::optional<std::size_t> tasks = queuedTasks(wait_.job_name);
    if (!tasks && !told_ && wait_.unanswered) wait_.unanswered();
    told_ = !tasks;
    return tasks && *tasks == 0;
  }

  void pause() const {
    constexpr std::chrono::milliseconds kStep{50};
    const auto begin = std::chrono::steady_clock::now();
    const std::chrono::duration<double> period(wait_.poll);
    while (!stop_ && std::chrono::steady_clock::now() - begin < period)
      std::this_thread::sleep_for(kStep);
  }

  std::deque<std::string> open_;
  const SlurmWait& wait_;
  const std::atomic<bool>& stop_;
  bool told_ = false;
};

}  // namespace

std::vector<std::string> waitForJobs(const std::vector<std::string>& ids, const SlurmWait& wait,
                                     const std::atomic<bool>& stop) {
  return JobWatch(ids, wait, stop).run();
}

}  // namespace cdiff::evaluation
