// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "core/program.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <new>
#include <system_error>

#include "core/folder_access.h"
#include "core/markup.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::core {
namespace {

// Global, because a signal handler has no other way to reach it.
std::atomic<bool> stop_requested{false};

void requestStop(int) { stop_requested = true; }

void endAtOnce(int) {
  static constexpr char kText[] = "interrupted\n";
  static_cast<void>(::write(STDERR_FILENO, kText, sizeof(kText) - 1));
  ::_exit(ExitCode::kInterrupted);
}

void handle(int signal, void (*handler)(int)) {
  struct sigaction action {};
  action.sa_handler = handler;
  ::sigaction(signal, &action, nullptr);
}

bool isIgnored(int signal) {
  struct sigaction action {};
  ::sigaction(signal, nullptr, &action);
  return (action.sa_flags & SA_SIGINFO) == 0 && action.sa_handler == SIG_IGN;
}

}  // namespace

void ignoreSignal(int signal) {
  struct sigaction action {};
  ::sigaction(signal, nullptr, &action);
  if ((action.sa_flags & SA_SIGINFO) != 0 || action.sa_handler != SIG_DFL) return;
  action.sa_handler = SIG_IGN;
  ::sigaction(signal, &action, nullptr);
}

void prepareProgram() {
  for (int descriptor = STDIN_FILENO; descriptor <= STDERR_FILENO; ++descriptor) {
    if (::fcntl(descriptor, F_GETFD) >= 0) continue;
    // open() takes the lowest free number, which is usually the missing one.
    const int opened = ::open("/dev/null", descriptor == STDIN_FILENO ? O_RDONLY : O_WRONLY);
    if (opened >= 0 && opened != descriptor) {
      ::dup2(opened, descriptor);
      ::close(opened);
    }
  }
  ignoreSignal(SIGPIPE);
  ignoreSignal(SIGXFSZ);
  if (isIgnored(SIGCHLD)) handle(SIGCHLD, SIG_DFL);  // else nobody learns how a child ended
  for (const int signal : stopSignals()) {
    if (!isIgnored(signal)) handle(signal, endAtOnce);
  }
}

std::vector<int> stopSignals() {
  std::vector<int> signals = {SIGINT, SIGTERM};
  if (!isIgnored(SIGHUP)) signals.push_back(SIGHUP);
  return signals;
}

const std::atomic<bool>& catchStopSignals() {
  stop_requested = false;
  for (const int signal : stopSignals()) handle(signal, requestStop);
  return stop_requested;
}

bool stopRequested() {
  if (stop_requested) return true;
  sigset_t pending;
  if (::sigpending(&pending) != 0) return false;
  for (const int signal : stopSignals()) {
    if (::sigismember(&pending, signal) == 1) return true;
  }
  return false;
}

std::string writeErrorText(int error) {
  const std::string text = std::strerror(error);
  rlimit limit{};
  if (error == EMFILE && ::getrlimit(RLIMIT_NOFILE, &limit) == 0)
    return text + ": this process may have " + std::to_string(limit.rlim_cur) +
           " open at a time; raise the limit with `ulimit -n`";
  if (error != EFBIG || ::getrlimit(RLIMIT_FSIZE, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY)
    return text;
  return text + ": this process may write no file beyond " + std::to_string(limit.rlim_cur) +
         " bytes; raise the limit with `ulimit -f`";
}

namespace {

template <class Type>
const Type* as(const std::exception& error) {
  return dynamic_cast<const Type*>(&error);
}

std::string pathText(const std::filesystem::filesystem_error& error) {
  const std::string first = error.path1().string();
  const std::string path = first.empty() ? "the working directory" : "'" + first + "'";
  return "cannot use " + path + ": " + writeErrorText(error.code().value()) +
         "; a path that exists and can be read was expected";
}

bool isOfTooMany(const std::filesystem::filesystem_error& error) {
  return error.code() == std::errc::too_many_files_open ||
         error.code() == std::errc::too_many_files_open_in_system;
}

}  // namespace

Failure failureOf(const std::exception& error) {
  const std::string text = error.what();
  if (as<TooManyOpenFiles>(error) != nullptr) return {ExitCode::kRunTimeError, text};
  if (as<InputError>(error) != nullptr) return {ExitCode::kBadInput, text};
  if (as<Interrupted>(error) != nullptr) return {ExitCode::kInterrupted, text};
  if (as<Error>(error) != nullptr) return {ExitCode::kRunTimeError, text};
  if (const auto* path = as<std::filesystem::filesystem_error>(error))
    return {isOfTooMany(*path) ? ExitCode::kRunTimeError : ExitCode::kBadInput, pathText(*path)};
  const auto* system = as<std::system_error>(error);
  if (system != nullptr && system->code() == std::errc::resource_unavailable_try_again) {
    return {ExitCode::kRunTimeError,
            "the system gives no further thread or process; raise `ulimit -u` and `ulimit -v`, or "
            "close other programs"};
  }
  if (as<std::bad_alloc>(error) != nullptr || as<std::length_error>(error) != nullptr) {
    return {
        ExitCode::kRunTimeError,
        "out of memory: the input asks for more than this machine can give; check its sizes, or "
        "use a machine with more memory"};
  }
  if (as<std::logic_error>(error) != nullptr) {
    return {
        ExitCode::kRunTimeError,
        "internal error (" + text + "); please report it together with the command and its input"};
  }
  return {ExitCode::kRunTimeError, text};
}

namespace {

int exitCodeOf(const std::function<int()>& call) {
  try {
    return call();
  } catch (const std::exception& error) {
    const Failure failure = failureOf(error);
    std::cerr << "cdiff: " << plainText(failure.text) << "\n";
    return failure.exit_code;
  }
}

/// Why the standard output did not take all that was printed; 0 where it did.
int outputError() {
  std::cout.flush();
  const bool flushed = std::fflush(stdout) == 0;
  if (flushed && !std::cout.bad() && std::ferror(stdout) == 0) return 0;
  // The write that failed may lie far behind: one more has the same reason.
  return ::write(STDOUT_FILENO, "\n", 1) < 0 ? errno : EIO;
}

}  // namespace

int reportFailure(const std::function<int()>& call) {
  const int exit_code = exitCodeOf(call);
  const int error = outputError();
  // A reader that closes its pipe ("| head") has read all that it wants.
  if (error == 0 || error == EPIPE) return exit_code;
  std::cerr << "cdiff: cannot write to the standard output: " << writeErrorText(error)
            << "; a file or terminal with room for what is printed was expected\n";
  return exit_code == ExitCode::kPassed ? ExitCode::kRunTimeError : exit_code;
}

}  // namespace cdiff::core
