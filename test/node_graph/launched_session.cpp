// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/launched_session.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <sstream>
#include <thread>

namespace cdiff::test {
namespace {

namespace fs = std::filesystem;

constexpr double kPatience = 120.0;  // [s]; only what hangs takes as long
int count = 0;                       // sessions of this program

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// As ROS stamps its messages on the terminal [s].
double wallNow() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

void pause() { std::this_thread::sleep_for(std::chrono::milliseconds(20)); }

std::string contentOf(const fs::path& file) {
  const std::ifstream stream(file, std::ios::binary);
  std::ostringstream content;
  content << stream.rdbuf();  // does not throw where the process ends meanwhile
  return content.str();
}

int freePort() {
  const int socket = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof(address);
  static_cast<void>(::bind(socket, reinterpret_cast<sockaddr*>(&address), size));
  ::getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size);
  ::close(socket);
  return ntohs(address.sin_port);
}

/// Whether a command line (spaces for zero bytes) is that of a process: a node is known by the name
/// that roslaunch gives it.
bool isProcess(const std::string& command, const std::string& name) {
  const std::string program = fs::path(command.substr(0, command.find(' '))).filename();
  if (name == "sumo") return program == "sumo";
  if (name == "rosmaster") return command.find("rosmaster --core") != std::string::npos;
  return command.find(" __name:=" + name + " ") != std::string::npos;
}

}  // namespace

LaunchedSession::LaunchedSession()
    : folder_(fs::temp_directory_path() /
              ("e2e_cdiff_launched_session_" + std::to_string(::getpid()) + "_" +
               std::to_string(++count))),
      port_(freePort()) {
  fs::remove_all(folder_);
  fs::create_directories(folder_);
}

LaunchedSession::~LaunchedSession() {
  if (launch_ > 0) ::kill(launch_, SIGKILL);
  for (const Process& process : processes()) ::kill(process.id, SIGKILL);
  if (launch_ > 0) ::waitpid(launch_, nullptr, 0);
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

void LaunchedSession::launch(const std::string& arguments) {
  start("exec roslaunch -p " + std::to_string(port_) +
        " e2e_cdiff session.launch results:=" + results().string() + " " + arguments);
}

void LaunchedSession::start(const std::string& command) {
  const std::string whole =
      "export PATH=/usr/bin:$PATH ROS_IP=127.0.0.1 ROS_HOME=" + folder_.string() +
      "/home ROS_MASTER_URI=http://127.0.0.1:" + std::to_string(port_) +
      " E2E_CDIFF_LAUNCHED_SESSION=" + folder_.string() +
      "; . " E2E_CDIFF_DEVEL "/setup.bash; cd " + folder_.string() + "; " + command;
  launch_ = ::fork();
  if (launch_ == 0) {
    ::setsid();
    ::signal(SIGINT, SIG_DFL);  // a shell ignores it in what it starts in the background
    const int log = ::open((folder_ / "log").c_str(), O_WRONLY | O_CREAT | O_APPEND, 0644);
    ::dup2(log, STDOUT_FILENO);
    ::dup2(log, STDERR_FILENO);
    ::execl("/bin/bash", "bash", "-c", whole.c_str(), nullptr);
    ::_exit(127);
  }
  noteSignal();
}

void LaunchedSession::noteSignal() {
  signaled_at_ = now();
  signaled_at_wall_ = wallNow();
}

std::vector<LaunchedSession::Process> LaunchedSession::processes() const {
  const std::string mark = "E2E_CDIFF_LAUNCHED_SESSION=" + folder_.string();
  std::vector<Process> found;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator("/proc", ignored)) {
    const std::string name = entry.path().filename().string();
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    std::string command = contentOf(entry.path() / "cmdline");
    std::replace(command.begin(), command.end(), '\0', ' ');
    const bool sumo_of_ours = command.find(folder_.string()) != std::string::npos;
    if (command.empty() ||
        (!sumo_of_ours && contentOf(entry.path() / "environ").find(mark) == std::string::npos))
      continue;
    found.push_back({static_cast<pid_t>(std::stol(name)), command});
  }
  return found;
}

pid_t LaunchedSession::process(const std::string& name) const {
  for (const double begin = now(); now() - begin < kPatience; pause()) {
    for (const Process& process : processes()) {
      if (process.id != launch_ && isProcess(process.command, name)) return process.id;
    }
  }
  return 0;
}

bool LaunchedSession::signal(const std::string& name, int number) {
  const pid_t id = process(name);
  noteSignal();
  return id > 0 && ::kill(id, number) == 0;
}

void LaunchedSession::signalLaunch(int number) {
  noteSignal();
  ::kill(launch_, number);
}

bool LaunchedSession::isScript() const {
  const fs::path command = "/proc/" + std::to_string(launch_) + "/cmdline";
  for (const double begin = now(); now() - begin < kPatience; pause()) {
    const std::string words = contentOf(command);  // bash, SCRIPT, ... with zero bytes between
    const std::size_t second = words.find('\0') + 1;
    if (fs::path(words.substr(second, words.find('\0', second) - second)).filename() == "session")
      return true;
  }
  return false;
}

bool LaunchedSession::hasFile(const std::string& name) const {
  for (const double begin = now(); now() - begin < kPatience; pause()) {
    if (fs::exists(results() / name)) return true;
  }
  return false;
}

bool LaunchedSession::hasTicks() const {
  constexpr std::uintmax_t kSize =
      1 << 16;  // [bytes] the writer writes its first tick, and then so many
  std::error_code ignored;
  for (const double begin = now(); now() - begin < kPatience; pause()) {
    for (const auto& entry : fs::directory_iterator(results(), ignored)) {
      const bool trace = entry.path().filename().string().rfind("trace.csv", 0) == 0;
      if (trace && fs::file_size(entry.path(), ignored) >= kSize) return true;
    }
  }
  return false;
}

double LaunchedSession::endAfter(double limit) {
  for (; now() - signaled_at_ < limit; pause()) {
    int status = 0;
    if (::waitpid(launch_, &status, WNOHANG) != launch_) continue;
    launch_ = 0;
    exit_status_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    return now() - signaled_at_;
  }
  return limit;
}

std::string LaunchedSession::leftovers() const {
  std::string commands;
  for (const double begin = now(); now() - begin < 2.0; pause()) {
    commands.clear();
    for (const Process& process : processes()) commands += process.command + "\n";
    if (commands.empty()) break;
  }
  return commands;
}

nlohmann::json LaunchedSession::summary() const {
  const std::string text = contentOf(results() / "summary.json");
  return text.empty() ? nlohmann::json::object() : nlohmann::json::parse(text, nullptr, false);
}

std::string LaunchedSession::fault() const {
  const nlohmann::json all = summary();
  if (!all.contains("faults") || all["faults"].empty()) return {};
  const nlohmann::json& last = all["faults"].back();
  return last["source"].get<std::string>() + ": " + last["text"].get<std::string>();
}

double LaunchedSession::errorAfter(const std::string& text) const {
  const std::string begin = "[ERROR] [";  // of "[ERROR] [WALL, SIMULATED]: TEXT"
  const std::string all = log();
  const std::size_t at = all.find(text);
  const std::size_t stamp = at == std::string::npos ? at : all.rfind(begin, at);
  if (stamp == std::string::npos) return std::numeric_limits<double>::quiet_NaN();
  return std::strtod(all.c_str() + stamp + begin.size(), nullptr) - signaled_at_wall_;
}

std::string LaunchedSession::exitCode() const { return contentOf(results() / "exit_code"); }
std::string LaunchedSession::log() const { return contentOf(folder_ / "log"); }

}  // namespace cdiff::test
