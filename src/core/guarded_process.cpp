// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "core/guarded_process.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>

#include "core/exit_code.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::core {

namespace {

constexpr std::chrono::milliseconds kGuardPeriod{50};

std::int64_t steadyNanoseconds() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

std::vector<char*> pointersTo(std::vector<std::string>& texts) {
  std::vector<char*> pointers;
  for (std::string& text : texts) pointers.push_back(text.data());
  pointers.push_back(nullptr);
  return pointers;
}

bool isProgram(const std::filesystem::path& file) {
  std::error_code unreadable;
  return std::filesystem::is_regular_file(file, unreadable) && ::access(file.c_str(), X_OK) == 0;
}

}  // namespace

std::filesystem::path findProgram(const std::string& name, const std::string& package) {
  if (name.find('/') != std::string::npos && isProgram(name)) return name;
  if (name.find('/') == std::string::npos && !name.empty()) {
    const char* path = std::getenv("PATH");
    for (const std::string& folder : splitText(path != nullptr ? path : "", ':')) {
      const std::filesystem::path file = std::filesystem::path(folder) / name;
      if (isProgram(file)) return file;
    }
  }
  throw InputError("the program '" + name + "' was not found; install the package " + package +
                   " or name the program's file");
}

std::vector<std::string> environmentWith(const std::string& name, const std::string& value) {
  std::vector<std::string> variables = {name + "=" + value};
  for (char** entry = environ; *entry != nullptr; ++entry) {
    if (std::string(*entry).rfind(name + "=", 0) != 0) variables.emplace_back(*entry);
  }
  return variables;
}

std::string signalText(int signal) {
  return "signal " + std::to_string(signal) + " (" + ::strsignal(signal) + ")";
}

/// What the child runs, laid out before the fork: between fork and exec only async-signal-safe
/// calls are allowed.
struct GuardedProcess::Image {
  std::string program;
  std::vector<std::string> arguments;
  std::vector<std::string> environment;
  std::string log;
  int input;
  int output;

  /// Runs in the child and does not return.
  [[noreturn]] void execute(pid_t parent, char* const* argv, char* const* envp) const {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (::getppid() != parent) ::_exit(127);
    ::setpgid(0, 0);
    sigset_t none;
    sigemptyset(&none);
    ::sigprocmask(SIG_SETMASK, &none, nullptr);
    const int from = input >= 0 ? input : ::open("/dev/null", O_RDONLY);
    const int to = output >= 0 ? output : ::open(log.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0644);
    if (from >= 0) ::dup2(from, STDIN_FILENO);
    if (to >= 0) {
      ::dup2(to, STDOUT_FILENO);
      ::dup2(to, STDERR_FILENO);
    }
    ::close_range(3, ~0U, 0);
    ::execve(program.c_str(), argv, envp);
    ::_exit(127);
  }
};

GuardedProcess::GuardedProcess(const std::filesystem::path& program,
                               const std::vector<std::string>& arguments,
                               const std::vector<std::string>& environment,
                               const ProcessStreams& streams) {
  Image image{program.string(),     arguments,     environment,
              streams.log.string(), streams.input, streams.output};
  image.arguments.insert(image.arguments.begin(), program.string());
  guardian_ = std::thread([this, image] { guard(image); });
  std::unique_lock<std::mutex> lock(mutex_);
  changed_.wait(lock, [this] { return started_; });
  if (start_error_ == 0) return;
  lock.unlock();
  guardian_.join();
  throw SimulatorError("a process for '" + program.string() +
                       "' could not be made: " + std::strerror(start_error_));
}

GuardedProcess::~GuardedProcess() {
  kill();
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  guardian_.join();
}

void GuardedProcess::publish(pid_t id, int error) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    id_ = id;
    start_error_ = error;
    started_ = true;
    reaped_ = error != 0;
  }
  changed_.notify_all();
}

void GuardedProcess::guard(const Image& image) {
  sigset_t all;
  sigfillset(&all);
  ::pthread_sigmask(SIG_SETMASK, &all, nullptr);
  Image own = image;
  const std::vector<char*> argv = pointersTo(own.arguments);
  const std::vector<char*> envp = pointersTo(own.environment);
  const pid_t parent = ::getpid();
  const pid_t child = ::fork();
  if (child == 0) own.execute(parent, argv.data(), envp.data());
  publish(child, child < 0 ? errno : 0);
  if (child < 0) return;
  std::unique_lock<std::mutex> lock(mutex_);
  while (!changed_.wait_for(lock, kGuardPeriod, [this] { return stopping_; })) {
    const std::int64_t deadline = deadline_.load();
    if (deadline == 0 || steadyNanoseconds() < deadline || reaped_) continue;
    deadline_missed_.store(true);
    ::kill(id_, SIGKILL);
  }
}

bool GuardedProcess::reap(bool wait) {
  if (reaped_) return true;
  pid_t answer = 0;
  do {
    answer = ::waitpid(id_, &status_, wait ? 0 : WNOHANG);
  } while (answer < 0 && errno == EINTR);
  reaped_ = answer != 0;  // an error means that someone else reaped it
  return reaped_;
}

bool GuardedProcess::ended() {
  const std::lock_guard<std::mutex> lock(mutex_);
  return reap(false);
}

bool GuardedProcess::waitForEnd(double seconds) {
  const std::int64_t limit = steadyNanoseconds() + static_cast<std::int64_t>(seconds * 1e9);
  while (!ended()) {
    if (steadyNanoseconds() > limit) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return true;
}

void GuardedProcess::kill() {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (reaped_) return;
  ::kill(id_, SIGKILL);
  reap(true);
}

int GuardedProcess::exitCode() {
  const int signal = endSignal();
  if (signal != 0) return ExitCode::kSignal + signal;
  const std::lock_guard<std::mutex> lock(mutex_);
  return reaped_ ? WEXITSTATUS(status_) : -1;
}

int GuardedProcess::endSignal() {
  if (!ended()) return 0;
  const std::lock_guard<std::mutex> lock(mutex_);
  return WIFSIGNALED(status_) ? WTERMSIG(status_) : 0;
}

std::string GuardedProcess::endText() {
  if (!ended()) return "still running";
  const int signal = endSignal();
  return signal != 0 ? signalText(signal) : "exit code " + std::to_string(exitCode());
}

void GuardedProcess::setDeadline(double seconds) {
  deadline_.store(steadyNanoseconds() + static_cast<std::int64_t>(seconds * 1e9));
}

void GuardedProcess::clearDeadline() { deadline_.store(0); }

}  // namespace cdiff::core
