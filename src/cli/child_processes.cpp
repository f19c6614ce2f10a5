// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "child_processes.h"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstring>
#include <map>

#include "e2e_cdiff/core/exceptions.h"
#include "stop_signals.h"

namespace cdiff::cli {
namespace {

pid_t start(const ChildProcess& child) {
  std::vector<std::string> words = {"cdiff"};
  words.insert(words.end(), child.words.begin(), child.words.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  pid_t process = 0;
  const int failed =
      posix_spawn(&process, "/proc/self/exe", nullptr, nullptr, argv.data(), environ);
  if (failed != 0) {
    throw core::SimulatorError("cannot start '" + child.name + "': " + std::strerror(failed));
  }
  return process;
}

}  // namespace

bool runChildren(std::vector<ChildProcess>& children, int at_a_time,
                 const std::function<void(const ChildProcess&)>& ended) {
  const std::atomic<bool>& stop = catchStopSignals();
  std::map<pid_t, std::size_t> running;
  std::size_t next = 0;
  while (!running.empty() || (next < children.size() && !stop)) {
    if (stop) {
      for (const auto& [process, index] : running) ::kill(process, SIGINT);
    } else if (next < children.size() && static_cast<int>(running.size()) < at_a_time) {
      running[start(children[next])] = next;
      ++next;
      continue;
    }
    int status = 0;
    const pid_t process = ::waitpid(-1, &status, 0);
    const auto found = running.find(process);
    if (found == running.end()) continue;  // a signal
    ChildProcess& child = children[found->second];
    child.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    running.erase(found);
    ended(child);
  }
  return !stop;
}

}  // namespace cdiff::cli
