// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "core/guarded_process.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>

#include "core/program.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::core {
namespace {

constexpr std::chrono::milliseconds kGuardPeriod{50};
constexpr off_t kLogReserve = 4096;  // [bytes]

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

std::vector<std::string> ourEnvironment() {
  std::vector<std::string> variables;
  for (char** entry = environ; *entry != nullptr; ++entry) variables.emplace_back(*entry);
  return variables;
}

bool isProgram(const std::filesystem::path& file) {
  std::error_code unreadable;
  return std::filesystem::is_regular_file(file, unreadable) && ::access(file.c_str(), X_OK) == 0;
}

}  // namespace

std::optional<std::filesystem::path> programInPath(const std::string& name) {
  const char* path = std::getenv("PATH");
  for (const std::string& folder : splitText(path != nullptr ? path : "", ':')) {
    const std::filesystem::path file = std::filesystem::path(folder) / name;
    if (isProgram(file)) return file;
  }
  return std::nullopt;
}

std::filesystem::path findProgram(const std::string& name, const std::string& package) {
  if (name.find('/') != std::string::npos && isProgram(name)) return name;
  if (name.find('/') == std::string::npos && !name.empty()) {
    if (const auto file = programInPath(name)) return *file;
  }
  throw InputError("the program '" + name + "' was not found; install the package " + package +
                   " or name the program's file");
}

std::vector<std::string> environmentWith(const std::string& name, const std::string& value) {
  std::vector<std::string> variables = {name + "=" + value};
  for (std::string& entry : ourEnvironment()) {
    if (entry.rfind(name + "=", 0) != 0) variables.push_back(std::move(entry));
  }
  return variables;
}

std::string signalText(int signal) {
  const std::string text = "signal " + std::to_string(signal) + " (" + ::strsignal(signal) + ")";
  if (signal == SIGKILL)
    return text + " from outside: from a person, or from the kernel, which was out of memory";
  if (signal == SIGXCPU)
    return text + ": more CPU time than it may take; raise the limit with `ulimit -t`";
  return text;
}

ProcessOutput::ProcessOutput() : descriptor_(::memfd_create("process output", MFD_CLOEXEC)) {}

bool ProcessOutput::isTooLong() const { return ::lseek(descriptor_.get(), 0, SEEK_END) > kMost; }

std::string ProcessOutput::end(std::size_t most) const {
  const off_t size = ::lseek(descriptor_.get(), 0, SEEK_END);
  std::string text(std::min(static_cast<std::size_t>(std::max<off_t>(size, 0)), most), '\0');
  const off_t begin = size - static_cast<off_t>(text.size());
  const ssize_t count = ::pread(descriptor_.get(), text.data(), text.size(), begin);
  text.resize(count > 0 ? static_cast<std::size_t>(count) : 0);
  return text;
}

namespace {

int openLog(const ProcessStreams& streams) {
  if (streams.log.empty()) return -1;
  const int mode = streams.append ? O_APPEND : O_TRUNC;
  const int log = ::open(streams.log.c_str(), O_WRONLY | O_CREAT | mode, 0644);
  // Room for the last words on a disk that fills up meanwhile; what is not used is not kept.
  if (log >= 0 && !streams.append) (void)::fallocate(log, FALLOC_FL_KEEP_SIZE, 0, kLogReserve);
  return log;
}

}  // namespace

void becomeChild(pid_t parent, const ProcessStreams& streams) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(127);
  ::setpgid(0, 0);
  sigset_t none;
  sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  ::signal(SIGINT, SIG_DFL);  // which shells ignore in what they start in the background
  const int from = streams.input >= 0 ? streams.input : ::open("/dev/null", O_RDONLY);
  const int to = streams.output >= 0 ? streams.output : openLog(streams);
  if (from >= 0) ::dup2(from, STDIN_FILENO);
  if (to >= 0) {
    ::dup2(to, STDOUT_FILENO);
    ::dup2(to, STDERR_FILENO);
  }
  ::close_range(3, ~0U, 0);
}

std::optional<int> reapGroup(pid_t leader, bool wait) {
  siginfo_t end{};
  int answer = 0;
  do {
    answer =
        ::waitid(P_PID, static_cast<id_t>(leader), &end, WEXITED | WNOWAIT | (wait ? 0 : WNOHANG));
  } while (answer < 0 && errno == EINTR);
  if (answer == 0 && end.si_pid == 0) return std::nullopt;
  int status = 0;
  if (answer != 0) return W_EXITCODE(ExitCode::kRunTimeError, 0);  // someone else reaped it
  ::kill(-leader, SIGKILL);                                        // what it left behind
  ::waitpid(leader, &status, 0);
  return status;
}

int exitCodeOf(int status) {
  return WIFSIGNALED(status) ? ExitCode::kSignal + WTERMSIG(status) : WEXITSTATUS(status);
}

/// What the child runs, laid out before the fork: between fork and exec only async-signal-safe
/// calls are allowed.
struct GuardedProcess::Image {
  std::string program;
  std::vector<std::string> arguments;
  std::vector<std::string> environment;
  ProcessStreams streams;

  /// Runs in the child and does not return.
  [[noreturn]] void execute(pid_t parent, char* const* argv, char* const* envp) const {
    becomeChild(parent, streams);
    ::execve(program.c_str(), argv, envp);
    ::_exit(127);
  }
};

GuardedProcess::GuardedProcess(const std::filesystem::path& program,
                               const std::vector<std::string>& arguments,
                               const std::vector<std::string>& environment,
                               const ProcessStreams& streams) {
  Image image{program.string(), arguments, environment.empty() ? ourEnvironment() : environment,
              streams};
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
  const int error = child < 0 ? errno : 0;
  if (child > 0) ::setpgid(child, child);  // whichever of the two comes first
  publish(child, error);
  if (child < 0) return;
  std::unique_lock<std::mutex> lock(mutex_);
  while (!changed_.wait_for(lock, kGuardPeriod, [this] { return stopping_; })) {
    const std::int64_t deadline = deadline_.load();
    if (deadline == 0 || steadyNanoseconds() < deadline || reaped_) continue;
    deadline_missed_.store(true);
    ::kill(-id_, SIGKILL);
  }
}

bool GuardedProcess::reap(bool wait) {
  if (reaped_) return true;
  const std::optional<int> status = reapGroup(id_, wait);
  reaped_ = status.has_value();
  if (status) status_ = *status;
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

bool GuardedProcess::waitForEnd(double seconds, const ProcessOutput& output) {
  constexpr double kLook = 0.05;  // [s]
  for (double waited = 0.0; waited < seconds; waited += kLook) {
    if (waitForEnd(std::min(kLook, seconds - waited))) return !output.isTooLong();
    if (!output.isTooLong()) continue;
    kill();
    return false;
  }
  return false;
}

void GuardedProcess::signal(int number) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!reaped_) ::kill(-id_, number);
}

void GuardedProcess::kill() {
  signal(SIGKILL);
  const std::lock_guard<std::mutex> lock(mutex_);
  reap(true);
}

int GuardedProcess::exitCode() {
  if (!ended()) return -1;
  const std::lock_guard<std::mutex> lock(mutex_);
  return exitCodeOf(status_);
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
