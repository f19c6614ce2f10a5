// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "core/fork_server.h"

#include <poll.h>
#include <signal.h>
#include <sys/signalfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <optional>
#include <sstream>

#include "core/forked_work.h"
#include "core/program.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::core {
namespace {

// Each message is one packet: a letter, and what follows it.
constexpr char kBegin = 'b';   ///< to the server: log and arguments, each with a 0 behind it
constexpr char kSignal = 's';  ///< to the server: number of a signal, as text
constexpr char kForked = 'f';  ///< to the client: the job has a process
constexpr char kEnded = 'e';   ///< to the client: exit code, as text
constexpr std::size_t kLargestMessage = 128 * 1024;  // [bytes]

bool sendMessage(int socket, const std::string& message) {
  return message.size() <= kLargestMessage &&
         ::send(socket, message.data(), message.size(), MSG_NOSIGNAL | MSG_DONTWAIT) ==
             static_cast<ssize_t>(message.size());
}

/// The next message; empty where the other side is gone, nullopt where there is none yet.
std::optional<std::string> receiveMessage(int socket) {
  std::string message(kLargestMessage, '\0');
  const ssize_t size = ::recv(socket, message.data(), message.size(), MSG_DONTWAIT);
  if (size < 0 && (errno == EAGAIN || errno == EINTR)) return std::nullopt;
  message.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
  return message;
}

/// Starts this program again in the present process; returns only where that fails.
int startAfresh(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "/proc/self/exe");
  std::vector<char*> pointers;
  for (std::string& argument : arguments) pointers.push_back(argument.data());
  pointers.push_back(nullptr);
  ::execv(pointers.front(), pointers.data());
  return ExitCode::kRunTimeError;
}

/// A descriptor that can be read when a child has ended; the signal is blocked from then on.
FileDescriptor childSignals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGCHLD);
  ::sigprocmask(SIG_BLOCK, &signals, nullptr);
  return FileDescriptor(::signalfd(-1, &signals, SFD_CLOEXEC | SFD_NONBLOCK));
}

/// The server: waits for messages of the client and for the end of its child.
class Service {
 public:
  Service(int control, const ForkPreparation& prepare)
      : control_(control), prepare_(prepare), signals_(childSignals()) {}

  int run() {
    if (!signals_) return ExitCode::kRunTimeError;
    while (true) {
      std::array<pollfd, 2> awaited = {{{control_, POLLIN, 0}, {signals_.get(), POLLIN, 0}}};
      if (::poll(awaited.data(), awaited.size(), -1) < 0) continue;  // interrupted
      if (awaited[1].revents != 0) buryChild();
      if (awaited[0].revents != 0 && !answer()) break;
    }
    if (child_ > 0) {
      ::kill(-child_, SIGKILL);
      reapGroup(child_, true);
    }
    return ExitCode::kPassed;
  }

 private:
  void buryChild() {
    signalfd_siginfo signal{};
    while (::read(signals_.get(), &signal, sizeof(signal)) > 0) {
    }
    const std::optional<int> status = child_ > 0 ? reapGroup(child_, false) : std::nullopt;
    if (!status) return;
    child_ = 0;
    sendMessage(control_, kEnded + std::to_string(exitCodeOf(*status)));
  }

  /// False when the client is gone.
  bool answer() {
    const std::optional<std::string> message = receiveMessage(control_);
    if (!message) return true;
    if (message->empty()) return false;
    if (message->front() == kSignal && child_ > 0) ::kill(-child_, std::stoi(message->substr(1)));
    if (message->front() == kBegin) begin(message->substr(1));
    return true;
  }

  void begin(const std::string& request) {
    std::istringstream parts(request);
    std::vector<std::string> arguments;
    ProcessStreams streams;
    streams.append = false;
    std::string part;
    if (std::getline(parts, part, '\0')) streams.log = part;
    while (std::getline(parts, part, '\0')) arguments.push_back(part);
    const ForkedRun run = prepare_(arguments);
    const bool alone = threadCount() == 1;
    const pid_t server = ::getpid();
    std::cout.flush();
    child_ = ::fork();
    if (child_ == 0) {
      becomeChild(server, streams);
      std::exit(alone ? run() : startAfresh(arguments));
    }
    if (child_ > 0) {
      ::setpgid(child_, child_);  // whichever of the two comes first
      sendMessage(control_, std::string(1, kForked));
      return;
    }
    std::cerr << "no process could be made for a job: " << std::strerror(errno) << std::endl;
    sendMessage(control_, kEnded + std::to_string(ExitCode::kRunTimeError));
  }

  int control_;
  const ForkPreparation& prepare_;
  FileDescriptor signals_;
  pid_t child_ = 0;  ///< 0: none is under way
};

}  // namespace

int serveForks(int control, const ForkPreparation& prepare) {
  return Service(control, prepare).run();
}

ForkServer::ForkServer(const std::filesystem::path& program,
                       const std::vector<std::string>& arguments) {
  int ends[2];
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0)
    throw SimulatorError(std::string("a socket for a server could not be made: ") +
                         std::strerror(errno));
  control_ = FileDescriptor(ends[0]);
  const FileDescriptor other(ends[1]);
  ProcessStreams streams;
  streams.input = other.get();
  process_ =
      std::make_unique<GuardedProcess>(program, arguments, std::vector<std::string>{}, streams);
}

void ForkServer::begin(const std::vector<std::string>& arguments,
                       const std::filesystem::path& log) {
  std::string request = kBegin + log.string() + '\0';
  for (const std::string& argument : arguments) request += argument + '\0';
  forked_ = false;
  ended_ = false;
  exit_code_ = -1;
  if (!sendMessage(control_.get(), request)) process_->signal(SIGKILL);  // else the job never ends
}

bool ForkServer::ended() {
  const bool gone = process_->ended();  // before the messages: what it sent counts
  while (!ended_) {
    const std::optional<std::string> message = receiveMessage(control_.get());
    if (!message || message->empty()) break;
    take(*message);
  }
  if (!ended_ && gone) {
    ended_ = true;
    exit_code_ = process_->exitCode();
  }
  return ended_;
}

void ForkServer::take(const std::string& message) {
  if (message.front() == kForked) forked_ = true;
  if (message.front() != kEnded) return;
  ended_ = true;
  exit_code_ = std::stoi(message.substr(1));
}

void ForkServer::signal(int number) {
  if (ended()) return;
  if (number == SIGKILL && !forked_) process_->signal(SIGKILL);
  sendMessage(control_.get(), kSignal + std::to_string(number));
}

}  // namespace cdiff::core
