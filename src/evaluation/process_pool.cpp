// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/process_pool.h"

#include <chrono>
#include <csignal>
#include <map>
#include <memory>
#include <thread>

#include "evaluation/child_process.h"

namespace cdiff::evaluation {

void runProcesses(const std::filesystem::path& program, std::vector<ProcessJob>& jobs,
                  int at_a_time, const std::atomic<bool>& stop,
                  const std::function<void(const ProcessJob&)>& ended) {
  constexpr std::chrono::milliseconds kPollPeriod{20};
  std::map<std::size_t, std::unique_ptr<ChildProcess>> running;  // by index of the job
  std::size_t next = 0;
  bool interrupted = false;
  while (!running.empty() || (next < jobs.size() && !stop)) {
    while (!stop && next < jobs.size() && static_cast<int>(running.size()) < at_a_time) {
      running[next] = std::make_unique<ChildProcess>(program, jobs[next].words, "");
      ++next;
    }
    if (stop && !interrupted) {
      interrupted = true;
      for (const auto& [index, process] : running) process->signal(SIGINT);
    }
    for (auto entry = running.begin(); entry != running.end();) {
      const auto exit_code = entry->second->poll();
      ProcessJob& job = jobs[entry->first];
      entry = exit_code ? running.erase(entry) : std::next(entry);
      if (!exit_code) continue;
      job.exit_code = *exit_code;
      ended(job);
    }
    if (!running.empty()) std::this_thread::sleep_for(kPollPeriod);
  }
}

}  // namespace cdiff::evaluation
