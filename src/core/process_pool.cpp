// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "core/process_pool.h"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <iterator>
#include <memory>
#include <optional>
#include <thread>

#include "core/fork_server.h"

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
  std::shared_ptr<ChildProcess> process;
  Clock::time_point begin = Clock::now();
  bool timed_out = false;
};

class ProcessPool {
 public:
  ProcessPool(std::deque<std::size_t> jobs, const PoolLimits& limits, const std::atomic<bool>& stop,
              const PoolCalls& calls, const std::optional<PoolServer>& server)
      : queue_(std::move(jobs)), limits_(limits), stop_(stop), calls_(calls), server_(server) {}

  void run() {
    while (!running_.empty() || (!queue_.empty() && !stop_)) {
      startNext();
      if (stop_) interrupt();
      killLate();
      const bool ended = collectEnded();
      if (!running_.empty() && !ended) std::this_thread::sleep_for(kPollPeriod);
    }
  }

 private:
  void startNext() {
    while (!stop_ && !queue_.empty() && static_cast<int>(running_.size()) < limits_.at_a_time) {
      const std::size_t number = queue_.front();
      queue_.pop_front();
      const std::optional<ProcessJob> job = calls_.start(number);
      if (!job) continue;
      Running started;
      started.job = number;
      started.process = server_ ? serve(*job) : startAlone(*job);
      running_.push_back(std::move(started));
    }
  }

  static std::shared_ptr<ChildProcess> startAlone(const ProcessJob& job) {
    ProcessStreams streams;
    streams.log = job.log;
    streams.append = false;
    return std::make_shared<GuardedProcess>(job.program, job.arguments, std::vector<std::string>{},
                                            streams);
  }

  /// By a server that has nothing to do, or else a new one.
  std::shared_ptr<ChildProcess> serve(const ProcessJob& job) {
    servers_.erase(std::remove_if(servers_.begin(), servers_.end(),
                                  [](const auto& server) { return !server->serves(); }),
                   servers_.end());
    // One whose job waits to be collected is also held by that job.
    auto idle = std::find_if(servers_.begin(), servers_.end(),
                             [](const auto& server) { return server.use_count() == 1; });
    if (idle == servers_.end()) {
      servers_.push_back(std::make_shared<ForkServer>(server_->program, server_->arguments));
      idle = std::prev(servers_.end());
    }
    (*idle)->begin(job.arguments, job.log);
    return *idle;
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

  /// Whether one has ended, so that another may start at once.
  bool collectEnded() {
    const std::size_t before = running_.size();
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
    return running_.size() != before;
  }

  std::deque<std::size_t> queue_;
  const PoolLimits& limits_;
  const std::atomic<bool>& stop_;
  const PoolCalls& calls_;
  const std::optional<PoolServer>& server_;
  std::vector<std::shared_ptr<ForkServer>> servers_;
  std::vector<Running> running_;
  std::optional<Clock::time_point> interrupted_at_;
};

}  // namespace

void runProcesses(std::deque<std::size_t> jobs, const PoolLimits& limits,
                  const std::atomic<bool>& stop, const PoolCalls& calls,
                  const std::optional<PoolServer>& server) {
  ProcessPool(std::move(jobs), limits, stop, calls, server).run();
}

}  // namespace cdiff::core
