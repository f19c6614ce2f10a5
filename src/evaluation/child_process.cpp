// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/child_process.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <map>
#include <memory>
#include <thread>

#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::evaluation {
namespace {

constexpr off_t kLogReserve = 4096;  // [bytes]

/// Runs in the child between fork and exec: async-signal-safe calls only.
[[noreturn]] void become(const char* program, char* const* argv, const char* log, pid_t parent) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(127);
  ::setpgid(0, 0);
  const int input = ::open("/dev/null", O_RDONLY);
  const int output = *log == '\0' ? -1 : ::open(log, O_WRONLY | O_CREAT | O_TRUNC, 0644);
  // Room for the last words on a disk that fills up meanwhile; what is not used is not kept.
  if (output >= 0) (void)::fallocate(output, FALLOC_FL_KEEP_SIZE, 0, kLogReserve);
  if (input >= 0) ::dup2(input, STDIN_FILENO);
  if (output >= 0) {
    ::dup2(output, STDOUT_FILENO);
    ::dup2(output, STDERR_FILENO);
  }
  ::close_range(3, ~0U, 0);
  ::execv(program, argv);
  ::_exit(127);
}

}  // namespace

ChildProcess::ChildProcess(const std::filesystem::path& program,
                           const std::vector<std::string>& arguments,
                           const std::filesystem::path& log) {
  std::vector<std::string> words = arguments;
  words.insert(words.begin(), program.filename().string());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const pid_t parent = ::getpid();
  process_ = ::fork();
  if (process_ == 0) become(program.c_str(), argv.data(), log.c_str(), parent);
  if (process_ < 0) {
    throw core::SimulatorError("cannot start a run: " + std::string(std::strerror(errno)));
  }
  ::setpgid(process_, process_);  // whichever of the two comes first
}

ChildProcess::~ChildProcess() {
  if (poll()) return;
  signal(SIGKILL);
  ::waitpid(process_, nullptr, 0);
}

std::optional<int> ChildProcess::poll() {
  if (exit_code_) return exit_code_;
  int status = 0;
  const pid_t answer = ::waitpid(process_, &status, WNOHANG);
  if (answer == process_) {
    exit_code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    ::kill(-process_, SIGKILL);  // what it left behind
  }
  return exit_code_;
}

void ChildProcess::signal(int number) const {
  if (!exit_code_) ::kill(-process_, number);
}

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
