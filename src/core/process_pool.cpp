// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "core/process_pool.h"

#include <chrono>
#include <csignal>
#include <memory>
#include <optional>
#include <thread>

#include "core/guarded_process.h"

namespace cdiff::core {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kPollPeriod{20};

double secondsSince(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// One process under way.
struct Running {
  std::size_t job = 0;
  std::unique_ptr<GuardedProcess> process;
  Clock::time_point begin = Clock::now();
  bool timed_out = false;
};

class ProcessPool {
 public:
  ProcessPool(std::deque<std::size_t> jobs, const PoolLimits& limits, const std::atomic<bool>& stop,
              const PoolCalls& calls)
      : queue_(std::move(jobs)), limits_(limits), stop_(stop), calls_(calls) {}

  void run() {
    while (!running_.empty() || (!queue_.empty() && !stop_)) {
      startNext();
      if (stop_) interrupt();
      killLate();
      collectEnded();
      if (!running_.empty()) std::this_thread::sleep_for(kPollPeriod);
    }
  }

 private:
  void startNext() {
    while (!stop_ && !queue_.empty() && static_cast<int>(running_.size()) < limits_.at_a_time) {
      const std::size_t number = queue_.front();
      queue_.pop_front();
      const ProcessJob job = calls_.start(number);
      ProcessStreams streams;
      streams.log = job.log;
      streams.append = false;
      Running started;
      started.job = number;
      started.process = std::make_unique<GuardedProcess>(job.program, job.arguments,
                                                         std::vector<std::string>{}, streams);
      running_.push_back(std::move(started));
    }
  }

  void interrupt() {
    if (interrupted_at_) return;
    interrupted_at_ = Clock::now();
    for (const Running& running : running_) running.process->signal(SIGINT);
  }

  void killLate() {
    const bool grace_over = interrupted_at_ && secondsSince(*interrupted_at_) > limits_.grace;
    for (Running& running : running_) {
      const bool late = secondsSince(running.begin) > limits_.timeout;
      if (running.timed_out || (!late && !grace_over)) continue;
      running.timed_out = late && !grace_over;
      running.process->signal(SIGKILL);
    }
  }

  void collectEnded() {
    for (std::size_t i = 0; i < running_.size();) {
      if (!running_[i].process->ended()) {
        ++i;
        continue;
      }
      const Running ended = std::move(running_[i]);
      running_.erase(running_.begin() + static_cast<std::ptrdiff_t>(i));
      const bool again =
          calls_.ended({ended.job, ended.process->exitCode(), secondsSince(ended.begin),
                        ended.timed_out, interrupted_at_.has_value()});
      if (again) queue_.push_front(ended.job);
    }
  }

  std::deque<std::size_t> queue_;
  const PoolLimits& limits_;
  const std::atomic<bool>& stop_;
  const PoolCalls& calls_;
  std::vector<Running> running_;
  std::optional<Clock::time_point> interrupted_at_;
};

}  // namespace

void runProcesses(std::deque<std::size_t> jobs, const PoolLimits& limits,
                  const std::atomic<bool>& stop, const PoolCalls& calls) {
  ProcessPool(std::move(jobs), limits, stop, calls).run();
}

}  // namespace cdiff::core
