// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "simulation/traci_link.h"

#include <arpa/inet.h>
#include <libsumo/Simulation.h>
#include <netinet/in.h>
#include <signal.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <thread>

#include "core/file.h"
#include "core/file_descriptor.h"
#include "core/forked_work.h"
#include "core/program.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::simulation {

namespace fs = std::filesystem;

namespace {

constexpr int kPortAttempts = 5;
constexpr std::chrono::milliseconds kListenPeriod{5};

/// States of a socket in the kernel's tables.
constexpr const char* kEstablished = "01";
constexpr const char* kListens = "0A";

/// Inode of a socket of this state on the local `port` according to one of the kernel's tables;
/// empty when there is none.
std::string inodeOf(const char* table, int port, const char* state) {
  std::ifstream file(table);
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    const std::vector<std::string> fields = core::splitText(line, ' ');
    if (fields.size() < 10 || fields[3] != state) continue;
    const std::size_t colon = fields[1].rfind(':');
    if (std::strtol(fields[1].c_str() + colon + 1, nullptr, 16) == port) return fields[9];
  }
  return "";
}

bool holdsSocket(int process_id, const std::string& inode) {
  const std::string wanted = "socket:[" + inode + "]";
  std::error_code error;
  fs::directory_iterator entries("/proc/" + std::to_string(process_id) + "/fd", error);
  if (error) return false;
  for (; entries != fs::directory_iterator(); entries.increment(error)) {
    if (error) return false;
    if (fs::read_symlink(entries->path(), error) == wanted) return true;
  }
  return false;
}

}  // namespace

int freePort() {
  const core::FileDescriptor handle(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_ANY);
  socklen_t size = sizeof(address);
  const bool bound = handle &&
                     ::bind(handle.get(), reinterpret_cast<sockaddr*>(&address), size) == 0 &&
                     ::getsockname(handle.get(), reinterpret_cast<sockaddr*>(&address), &size) == 0;
  if (!bound) throw core::SimulatorError("no free TCP port was found for SUMO");
  return ntohs(address.sin_port);
}

/// Between fork and exec the child is still a copy of this program, with all its sockets.
bool hasExecutedItsProgram(int process_id) {
  std::error_code error;
  const fs::path child = fs::read_symlink("/proc/" + std::to_string(process_id) + "/exe", error);
  return !error && child != fs::read_symlink("/proc/self/exe", error);
}

/// Whether a process holds a socket of this state on a local TCP port.
bool holdsSocketOn(int process_id, int port, const char* state) {
  if (!hasExecutedItsProgram(process_id)) return false;
  for (const char* table : {"/proc/net/tcp", "/proc/net/tcp6"}) {
    const std::string inode = inodeOf(table, port, state);
    if (!inode.empty() && holdsSocket(process_id, inode)) return true;
  }
  return false;
}

bool listensOn(int process_id, int port) { return holdsSocketOn(process_id, port, kListens); }

SumoProcess::SumoProcess(const SumoCommand& command) : logs_(command.log_folder) {
  const fs::path program = core::findProgram(command.binary, "sumo");
  Start start = Start::kPortTaken;
  for (int attempt = 0; attempt < kPortAttempts; ++attempt) {
    start = tryStart(command, program);
    if (start == Start::kListening) return;
  }
  const std::string tried =
      std::to_string(kPortAttempts) + " attempts, the last one on port " + std::to_string(port_);
  throw core::SimulatorError(start == Start::kPortTaken
                                 ? "SUMO found no free port in " + tried
                                 : "another program connected to SUMO before this one in " + tried);
}

SumoProcess::~SumoProcess() = default;

SumoProcess::Start SumoProcess::tryStart(const SumoCommand& command, const fs::path& program) {
  std::error_code ignored;
  fs::remove(logs_.errorLog(), ignored);
  fs::remove(logs_.output(), ignored);
  port_ = command.choose_port();
  std::vector<std::string> arguments = {"--remote-port", std::to_string(port_),
                                        "--num-clients", "1",
                                        "--error-log",   logs_.errorLog().string()};
  arguments.insert(arguments.end(), command.arguments.begin(), command.arguments.end());
  process_ = std::make_unique<core::GuardedProcess>(
      program, arguments, core::environmentWith("SUMO_HOME", core::sumoHome().string()),
      core::ProcessStreams{logs_.output()});
  const auto limit =
      std::chrono::steady_clock::now() + std::chrono::duration<double>(command.start_timeout);
  while (!listensOn(process_->id(), port_)) {
    if (process_->ended()) {
      const std::string words = lastWords();
      if (words.find("already in use") != std::string::npos) return Start::kPortTaken;
      if (hasMetOtherClient()) return Start::kOtherClient;
      if (const std::string reason = refusal(); !reason.empty()) throw SumoRefusal(reason);
      throw core::SimulatorError("SUMO did not start (" + process_->endText() + "): " + words);
    }
    if (hasMetOtherClient()) return Start::kOtherClient;
    if (std::chrono::steady_clock::now() > limit) {
      throw core::SimulatorError("SUMO did not listen within " +
                                 core::formatNumber(command.start_timeout) + " s");
    }
    std::this_thread::sleep_for(kListenPeriod);
  }
  return Start::kListening;
}

std::string SumoProcess::lastWords() const {
  const std::string errors = lastLines(logs_.errorLog());
  if (!errors.empty()) return errors;
  const std::string output = lastLines(logs_.output());
  return output.empty() ? "its log is empty" : output;
}

std::string SumoProcess::refusal() const {
  if (!process_->ended()) return "";
  const std::string error = sentenceAfter("Error: ", logs_.errorLog());
  const int signal = process_->endSignal();
  if (signal == 0) return error;
  if (signal != SIGABRT && signal != SIGSEGV && signal != SIGFPE && signal != SIGBUS) return "";
  const std::string assertion = sentenceAfter("Assertion ", logs_.output());
  std::string text = "it crashed, " + process_->endText();
  if (!error.empty()) text += ": " + error;
  return text + (assertion.empty() ? "" : ": assertion " + assertion);
}

bool SumoProcess::hasMetOtherClient() const {
  if (!process_->ended()) return holdsSocketOn(process_->id(), port_, kEstablished);
  // What SUMO and its assertions say of a client that sends what is no request, or goes.
  const std::string words = lastWords();
  const auto tells_of = [&](const char* part) { return words.find(part) != std::string::npos; };
  return tells_of("tcpip::Socket::rec") || tells_of("Storage::");
}

/// Says what is being called, selects this session, holds signals back (an interrupted read would
/// look like a lost SUMO) and sets the deadline.
class TraciLink::Deadline : public Guard {
 public:
  explicit Deadline(TraciLink& link) : link_(link) {
    sigset_t all;
    sigfillset(&all);
    for (int fault : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGTRAP}) sigdelset(&all, fault);
    ::pthread_sigmask(SIG_SETMASK, &all, &previous_);
    link_.sumo_.process().setDeadline(link_.limit_);
  }
  ~Deadline() override {
    link_.sumo_.process().clearDeadline();
    ::pthread_sigmask(SIG_SETMASK, &previous_, nullptr);
  }

 private:
  /// An answer that libtraci cannot read fails one of its assertions, which ends the process.
  core::NamedCall call_{core::kSimulatorCall, "libtraci", core::NamedCall::Limit::kNone};
  TraciLink& link_;
  sigset_t previous_;
};

TraciLink::TraciLink(const SumoCommand& command, double call_timeout)
    : SumoLink(*cdiffSumoCalls()),
      sumo_(command),
      limit_(command.start_timeout),
      label_("sumo_" + std::to_string(sumo_.process().id()) + "_" + std::to_string(sumo_.port())) {
  core::ignoreSignal(SIGPIPE);  // libtraci writes to the socket of a SUMO that is gone, too
  connect();
  loaded_ = true;
  limit_ = call_timeout;
}

void TraciLink::connect() {
  constexpr int kRetries = 0;  // SUMO listens
  const Deadline deadline(*this);
  try {
    version_ = libtraci::Simulation::init(sumo_.port(), kRetries, "127.0.0.1", label_).second;
    connected_ = true;
  } catch (...) {
    fail("loading the network and the demand");
  }
}

std::unique_ptr<SumoLink::Guard> TraciLink::guardCall() {
  auto deadline = std::make_unique<Deadline>(*this);
  libtraci::Simulation::switchConnection(label_);
  return deadline;
}

TraciLink::~TraciLink() {
  if (!connected_ || sumo_.process().ended()) return;
  try {
    guarded("close", [this] { calls().close(); });
  } catch (const core::Error&) {
    // SUMO was lost at its very end: the process is ended in any case.
  }
}

std::string TraciLink::lossText(const std::string& what, const std::string& reason) {
  connected_ = false;
  core::GuardedProcess& process = sumo_.process();
  // The socket closes a moment before the process is gone, a longer one where it crashes.
  process.waitForEnd(loaded_ ? 0.3 : 3.0);
  if (process.deadlineMissed()) {
    return "SUMO did not answer for " + core::formatNumber(limit_) + " s (" + what +
           ") and was ended";
  }
  const bool hung_up = reason.rfind("tcpip::Socket", 0) == 0 || reason.rfind("send failed", 0) == 0;
  if (!loaded_ && hung_up && sumo_.hasMetOtherClient()) {
    throw OtherClient("another program connected to SUMO's port " + std::to_string(sumo_.port()) +
                      " before this one; end it");
  }
  const std::string refusal = sumo_.refusal();
  if (!refusal.empty() && (!loaded_ || process.endSignal() == 0)) throw SumoRefusal(refusal);
  const std::string end = process.endText();
  process.kill();
  return "SUMO was lost (" + what + "; " + end + "; " + reason + "): " + sumo_.lastWords();
}

}  // namespace cdiff::simulation
