// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "simulation/sumo_process.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <signal.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <thread>

#include "core/file.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::simulation {

namespace fs = std::filesystem;

namespace {

constexpr int kPortAttempts = 5;
constexpr std::chrono::milliseconds kListenPeriod{5};

/// Inode of the socket that listens on `port` according to one of the kernel's tables; empty when
/// there is none.
std::string listeningInode(const char* table, int port) {
  std::ifstream file(table);
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    const std::vector<std::string> fields = core::splitText(line, ' ');
    if (fields.size() < 10 || fields[3] != "0A") continue;
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

/// What follows `mark` on the first line that holds it, with the lines that continue it (indented,
/// or after a semicolon); empty when no line does.
std::string sentenceAfter(const std::string& mark, const fs::path& path) {
  std::ifstream file(path);
  std::string line;
  while (std::getline(file, line)) {
    const std::size_t at = line.find(mark);
    if (at == std::string::npos) continue;
    std::string sentence = line.substr(at + mark.size());
    while (std::getline(file, line) && !line.empty() && line.front() == ' ') sentence += line;
    return sentence;
  }
  return "";
}

/// The last lines of a text file in one line; empty when there are none.
std::string lastLines(const fs::path& path) {
  constexpr std::size_t kLines = 4;
  std::ifstream file(path);
  std::vector<std::string> lines;
  for (std::string line; std::getline(file, line);) {
    if (!line.empty()) lines.push_back(line);
  }
  if (lines.size() > kLines) lines.erase(lines.begin(), lines.end() - kLines);
  return core::joinText(lines, " | ");
}

}  // namespace

int freePort() {
  const int handle = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_ANY);
  socklen_t size = sizeof(address);
  const bool bound = handle >= 0 &&
                     ::bind(handle, reinterpret_cast<sockaddr*>(&address), size) == 0 &&
                     ::getsockname(handle, reinterpret_cast<sockaddr*>(&address), &size) == 0;
  if (handle >= 0) ::close(handle);
  if (!bound) throw core::SimulatorError("no free TCP port was found for SUMO");
  return ntohs(address.sin_port);
}

/// Between fork and exec the child is still a copy of this program, with all its sockets.
bool hasBecomeItsProgram(int process_id) {
  std::error_code error;
  const fs::path child = fs::read_symlink("/proc/" + std::to_string(process_id) + "/exe", error);
  return !error && child != fs::read_symlink("/proc/self/exe", error);
}

bool listensOn(int process_id, int port) {
  if (!hasBecomeItsProgram(process_id)) return false;
  for (const char* table : {"/proc/net/tcp", "/proc/net/tcp6"}) {
    const std::string inode = listeningInode(table, port);
    if (!inode.empty() && holdsSocket(process_id, inode)) return true;
  }
  return false;
}

LogFolder::LogFolder(const fs::path& wanted) : path_(wanted) {
  if (wanted.empty()) {
    scratch_ = std::make_unique<core::ScratchFolder>();
    path_ = scratch_->path();
    return;
  }
  std::error_code error;
  fs::create_directories(path_, error);
  if (error)
    throw core::InputError("folder for SUMO's log '" + path_.string() + "': " + error.message());
}

SumoProcess::SumoProcess(const SumoCommand& command) : logs_(command.log_folder) {
  const fs::path program = core::findProgram(command.binary, "sumo");
  for (int attempt = 0; attempt < kPortAttempts; ++attempt) {
    if (tryStart(command, program) == Start::kListening) return;
  }
  throw core::SimulatorError("SUMO found no free port in " + std::to_string(kPortAttempts) +
                             " attempts, the last one was " + std::to_string(port_));
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
      if (const std::string reason = refusal(); !reason.empty()) throw SumoRefusal(reason);
      throw core::SimulatorError("SUMO did not start (" + process_->endText() + "): " + words);
    }
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

}  // namespace cdiff::simulation
