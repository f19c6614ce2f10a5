// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "core/forked_work.h"

#include <pthread.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <iterator>
#include <new>
#include <thread>
#include <utility>
#include <vector>

#include "core/guarded_process.h"
#include "core/program.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::core {
namespace {

constexpr double kStopPatience = 10.0;       // [s] for a call that goes on when a stop signal comes
constexpr double kSecondStopPatience = 1.0;  // [s] for it when another one comes
constexpr double kEndPatience = 70.0;        // [s] for what follows a result; a video may take 60 s
constexpr double kSameStop = 0.5;  // [s]: a terminal and a parent process may both send a signal
constexpr std::chrono::milliseconds kLookPeriod{10};

std::int64_t steadyNow() {
  return std::chrono::steady_clock::now().time_since_epoch() / std::chrono::nanoseconds(1);
}

double secondsFrom(std::int64_t begin) { return 1e-9 * static_cast<double>(steadyNow() - begin); }

/// What both processes see: the copy writes, the other one reads.
struct SharedState {
  std::atomic<bool> returned{false};
  std::atomic<WorkStage> stage{WorkStage::kNothing};
  std::atomic<std::int64_t> since{0};  ///< of the call [ns of the steady clock]; 0: none
  std::atomic<NamedCall::Limit> limit{NamedCall::Limit::kNone};
  std::array<char, 256> call{};  ///< "KIND:NAME"; empty: none
};

// Global, because a call has no other way to reach it; null where nobody waits for this process.
SharedState* shared_state = nullptr;
/// Whether this thread is the one that says what it calls.
thread_local bool names_calls = false;

/// In every other copy of this process: nobody waits for its calls.
void forgetWaiting() {
  shared_state = nullptr;
  names_calls = false;
}

void setCall(const std::string& call, std::int64_t since, NamedCall::Limit limit) {
  shared_state->since = 0;
  std::array<char, 256>& text = shared_state->call;
  text[call.copy(text.data(), text.size() - 1)] = '\0';
  shared_state->limit = limit;
  shared_state->since = since;
}

/// The state of one copy, in memory of both processes.
class SharedMemory {
 public:
  SharedMemory()
      : place_(::mmap(nullptr, sizeof(SharedState), PROT_READ | PROT_WRITE,
                      MAP_SHARED | MAP_ANONYMOUS, -1, 0)) {
    if (place_ == MAP_FAILED) throw std::bad_alloc();
    state_ = new (place_) SharedState;
  }
  ~SharedMemory() { ::munmap(place_, sizeof(SharedState)); }
  SharedMemory(const SharedMemory&) = delete;
  SharedMemory& operator=(const SharedMemory&) = delete;
  SharedState& state() const { return *state_; }

 private:
  void* place_;
  SharedState* state_ = nullptr;
};

/// Runs in the copy and does not return.
[[noreturn]] void work(const std::function<int()>& body, SharedState& state, pid_t parent) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(ExitCode::kRunTimeError);
  shared_state = &state;
  names_calls = true;
  const int exit_code = body();
  std::cout << std::flush;
  std::fflush(nullptr);
  state.returned = true;
  ::_exit(exit_code);
}

/// Waits for the end of a copy.
class Waiting {
 public:
  Waiting(pid_t child, const SharedState& state, double call_limit, const std::atomic<bool>& stop)
      : child_(child), state_(state), call_limit_(call_limit), stop_(stop) {}

  WorkEnd end() {
    const int status = waitForStatus();
    WorkEnd end;
    end.stage = state_.stage;
    end.interrupted = stops_ > 0 || stop_;
    if (state_.returned && WIFEXITED(status)) {
      end.exit_code = WEXITSTATUS(status);
      return end;
    }
    end.how = !how_.empty()         ? how_
              : WIFSIGNALED(status) ? signalText(WTERMSIG(status))
                                    : "exit code " + std::to_string(WEXITSTATUS(status));
    if (how_.empty() && isStopped(status)) end.interrupted = true;
    end.from_outside = how_.empty() && (isStopped(status) || isKilled(status));
    if (end.from_outside || (!how_.empty() && !by_call_)) return end;
    const std::string call = state_.call.data();
    const std::size_t colon = call.find(':');
    end.kind = call.substr(0, colon);
    if (colon != std::string::npos) end.name = call.substr(colon + 1);
    return end;
  }

 private:
  /// As ::waitpid gives it; exit code 2 where another part of the program reaped the copy.
  int waitForStatus() {
    int status = 0;
    pid_t ended = 0;
    while ((ended = ::waitpid(child_, &status, WNOHANG)) == 0) {
      if (stop_) passOn();
      if (how_.empty()) endWhatGoesOn();
      std::this_thread::sleep_for(kLookPeriod);
    }
    return ended == child_ ? status : W_EXITCODE(ExitCode::kRunTimeError, 0);
  }

  /// By a stop signal, which ends a program that does not catch it with this exit code.
  static bool isStopped(int status) {
    if (WIFEXITED(status)) return WEXITSTATUS(status) == ExitCode::kInterrupted;
    const std::vector<int> signals = stopSignals();
    return std::count(signals.begin(), signals.end(), WTERMSIG(status)) > 0;
  }

  /// By a signal that comes from outside alone.
  static bool isKilled(int status) {
    return WIFSIGNALED(status) && (WTERMSIG(status) == SIGKILL || WTERMSIG(status) == SIGXCPU);
  }

  void passOn() {
    catchStopSignals();  // clears `stop_`, for the next signal
    const bool again = stops_ > 0 && secondsFrom(stopped_at_) > kSameStop;
    if (stops_ == 0) stopped_at_ = steadyNow();
    if (stops_ == 0 || again) ++stops_;
    ::kill(child_, SIGINT);
  }

  /// Whether a call that began then is given up because of the stop signals.
  bool isGivenUp(std::int64_t since) const {
    if (stops_ == 0) return false;
    const double seconds = secondsFrom(std::max(since, stopped_at_));
    return seconds > (stops_ > 1 ? kSecondStopPatience : kStopPatience);
  }

  /// Whether the work does not end though its result is written and a stop signal came.
  bool isEndless() {
    if (state_.stage != WorkStage::kResultWritten || stops_ == 0) return false;
    if (written_at_ == 0) written_at_ = steadyNow();
    const double seconds = secondsFrom(std::max(written_at_, stopped_at_));
    return seconds > (stops_ > 1 ? kStopPatience : kEndPatience);
  }

  void endWhatGoesOn() {
    using Limit = NamedCall::Limit;
    const std::int64_t since = state_.since;
    const Limit limit = since == 0 ? Limit::kNone : state_.limit.load();
    if (state_.since != since) return;  // another call has begun
    const double seconds = since == 0 ? 0.0 : secondsFrom(since);
    const bool late = limit == Limit::kOfTheWork && seconds > call_limit_;
    if (late || (limit != Limit::kNone && isGivenUp(since))) {
      by_call_ = true;
      endNow("no answer for " + formatFixed(seconds, 0) + " s");
    } else if (isEndless()) {
      endNow("it went on, though it was stopped");
    }
  }

  void endNow(std::string how) {
    how_ = std::move(how);
    ::kill(child_, SIGKILL);
  }

  pid_t child_;
  const SharedState& state_;
  double call_limit_;
  const std::atomic<bool>& stop_;
  int stops_ = 0;
  std::int64_t stopped_at_ = 0;
  std::int64_t written_at_ = 0;  ///< when the result was seen to be written; 0: not yet
  std::string how_;              ///< why it was ended; empty where it was not
  bool by_call_ = false;         ///< for a call that went on
};

}  // namespace

NamedCall::NamedCall(const char* kind, const std::string& name, Limit limit) {
  if (!names_calls) return;
  before_ = shared_state->call.data();
  since_before_ = shared_state->since;
  limit_before_ = shared_state->limit;
  setCall(std::string(kind) + ":" + name, steadyNow(), limit);
}

NamedCall::~NamedCall() {
  if (names_calls) setCall(before_, since_before_, limit_before_);
}

void reachStage(WorkStage stage) {
  if (shared_state != nullptr) shared_state->stage = stage;
}

std::size_t threadCount() {
  const std::filesystem::directory_iterator threads("/proc/self/task");
  return static_cast<std::size_t>(std::distance(begin(threads), end(threads)));
}

WorkEnd runForked(const std::function<int()>& body, double call_limit,
                  const std::atomic<bool>& stop) {
  static const int forgets = ::pthread_atfork(nullptr, nullptr, forgetWaiting);
  static_cast<void>(forgets);
  const SharedMemory memory;
  std::cout << std::flush;  // else the copy would print it once more
  std::fflush(nullptr);
  const pid_t parent = ::getpid();
  const pid_t child = ::fork();
  if (child < 0)
    throw SimulatorError(std::string("a process could not be made: ") + std::strerror(errno));
  if (child == 0) work(body, memory.state(), parent);
  return Waiting(child, memory.state(), call_limit, stop).end();
}

}  // namespace cdiff::core
