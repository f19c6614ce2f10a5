// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/lockstep/node_process.h"

#include <pthread.h>
#include <signal.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <fstream>
#include <pugixml.hpp>
#include <sstream>
#include <vector>

#include "core/file.h"
#include "core/program.h"
#include "core/spelling.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::node_graph {
namespace {

std::atomic<bool> signaled{false};  // a signal goes to one thread, and means all

sigset_t stopSignals() {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int signal : core::stopSignals()) sigaddset(&signals, signal);
  return signals;
}

}  // namespace

StopSignal::StopSignal() {
  const sigset_t signals = stopSignals();
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
}

bool StopSignal::raised() {
  const sigset_t signals = stopSignals();
  const timespec at_once{0, 0};
  if (sigtimedwait(&signals, nullptr, &at_once) > 0) signaled = true;
  return raised_ || signaled;
}

namespace {

namespace fs = std::filesystem;

constexpr const char* kPackage = "e2e_cdiff";

fs::path processFolder(pid_t id) { return fs::path("/proc") / std::to_string(id); }

/// A file of /proc; empty when the process has ended or is another user's.
std::string contentOf(const fs::path& file) {
  const std::ifstream stream(file, std::ios::binary);
  std::ostringstream content;
  content << stream.rdbuf();  // does not throw where the process ends meanwhile
  return content.str();
}

/// The texts of cmdline or environ, which end with a zero byte each.
std::vector<std::string> textsOf(pid_t id, const char* file) {
  return core::splitText(contentOf(processFolder(id) / file), '\0');
}

/// Fields of /proc/ID/stat from the third one (state) on; the second one may hold spaces.
std::vector<std::string> statOf(pid_t id) {
  const std::string text = contentOf(processFolder(id) / "stat");
  const std::size_t end_of_name = text.rfind(") ");
  if (end_of_name == std::string::npos) return {};
  return core::splitText(text.substr(end_of_name + 2), ' ');
}

pid_t parentOf(pid_t id) {
  const std::vector<std::string> fields = statOf(id);
  return fields.size() < 2 ? 0 : static_cast<pid_t>(std::stol(fields[1]));
}

bool holds(const std::vector<std::string>& texts, const std::string& text) {
  return std::find(texts.begin(), texts.end(), text) != texts.end();
}

std::string variable(const std::vector<std::string>& environment, const std::string& name) {
  for (const std::string& text : environment) {
    if (text.rfind(name + "=", 0) == 0) return text.substr(name.size() + 1);
  }
  return {};
}

bool sameGraph(pid_t id) {
  const std::vector<std::string> own = textsOf(::getpid(), "environ");
  const std::vector<std::string> others = textsOf(id, "environ");
  return variable(own, "ROS_MASTER_URI") == variable(others, "ROS_MASTER_URI") &&
         variable(own, "ROS_NAMESPACE") == variable(others, "ROS_NAMESPACE");
}

std::vector<pid_t> processes() {
  std::vector<pid_t> ids;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator("/proc", ignored)) {
    const std::string name = entry.path().filename().string();
    if (name.find_first_not_of("0123456789") == std::string::npos)
      ids.push_back(static_cast<pid_t>(std::stol(name)));
  }
  return ids;
}

std::string trimmed(const std::string& text) {
  const std::size_t begin = text.find_first_not_of(' ');
  if (begin == std::string::npos) return {};
  return text.substr(begin, text.find_last_not_of(' ') + 1 - begin);
}

bool isLaunchFile(const std::string& argument) {
  const fs::path extension = fs::path(argument).extension();
  return extension == ".launch" || extension == ".test" || extension == ".xml";
}

/// The launch file that an argument of roslaunch names, after the package that may stand before it,
/// where it is one of ours; else empty.
fs::path ownLaunchFile(const std::string& before, const std::string& argument,
                       const fs::path& folder) {
  const fs::path own = core::shareFolder() / "launch" / fs::path(argument).filename();
  std::error_code error;
  const bool of_package = before == kPackage && fs::path(argument).filename() == argument;
  if (!of_package && !fs::equivalent(folder / argument, own, error)) return {};
  return fs::exists(own, error) ? own : fs::path();
}

/// As roslaunch reads it: an argument without a value counts as not given, and `_name` is a private
/// parameter.
void takeArgument(LaunchCommand& command, const std::string& text, std::size_t sign) {
  const std::string name = trimmed(text.substr(0, sign));
  const std::string value = trimmed(text.substr(sign + 2));
  if (!name.empty() && name.front() != '_' && !value.empty()) command.arguments[name] = value;
}

/// roslaunch leaves an argument out where it finds no NAME:=VALUE in one line.
void requireHeededValue(const std::string& name, const std::string& value) {
  const bool broken = value.find('\n') != std::string::npos;
  if (!broken && value.find(":=") == std::string::npos) return;
  throw core::InputError("the value of argument '" + name + "' holds " +
                         (broken ? "a line break" : "':='") +
                         ", with which roslaunch ignores the whole argument; expected one line "
                         "without ':='");
}

/// Names of the arguments that a launch file declares.
std::vector<std::string> declaredArguments(const fs::path& launch_file) {
  const std::string text = core::readFile(launch_file, "launch file");
  pugi::xml_document document;
  document.load_buffer(text.data(), text.size());
  std::vector<std::string> names;
  for (const pugi::xml_node& argument : document.child("launch").children("arg"))
    names.emplace_back(argument.attribute("name").value());
  return names;
}

}  // namespace

std::optional<pid_t> launchedProcess(const std::string& node) {
  const pid_t parent = ::getppid();
  for (const pid_t id : processes()) {
    if (id == ::getpid() || parentOf(id) != parent) continue;
    if (holds(textsOf(id, "cmdline"), "__name:=" + node) && sameGraph(id)) return id;
  }
  return std::nullopt;
}

bool killLaunchedProcess(const std::string& node) {
  const std::optional<pid_t> id = launchedProcess(node);
  return id && ::kill(*id, SIGKILL) == 0;
}

void endLaunch(StopSignal& stop) {
  constexpr double kPatience = 5.0;  // [s]
  const std::vector<std::string> command = textsOf(::getppid(), "cmdline");
  const bool launched = std::any_of(command.begin(), command.end(), [](const std::string& text) {
    return fs::path(text).filename() == "roslaunch";
  });
  if (!launched || stop.raised() || ::kill(::getppid(), SIGINT) != 0) return;
  const auto begin = std::chrono::steady_clock::now();
  while (!stop.raised() && secondsSince(begin) < kPatience) spin(kSpinPeriod);
}

std::optional<double> launchTime() {
  constexpr std::size_t kStartTime = 19;  // field 22 of proc(5), the third one being the first here
  const std::vector<std::string> fields = statOf(::getppid());
  if (fields.size() <= kStartTime) return std::nullopt;
  timespec now{};
  timespec up{};
  ::clock_gettime(CLOCK_REALTIME, &now);
  ::clock_gettime(CLOCK_BOOTTIME, &up);
  const double boot = static_cast<double>(now.tv_sec - up.tv_sec) +
                      1e-9 * static_cast<double>(now.tv_nsec - up.tv_nsec);
  return boot + std::stod(fields[kStartTime]) / static_cast<double>(::sysconf(_SC_CLK_TCK));
}

std::optional<LaunchCommand> launchCommand() {
  const std::vector<std::string> arguments = textsOf(::getppid(), "cmdline");
  LaunchCommand command;
  std::error_code ignored;
  command.folder = fs::read_symlink(processFolder(::getppid()) / "cwd", ignored);
  int launch_files = 0;
  for (std::size_t i = 1; i < arguments.size(); ++i) {
    const std::size_t sign = arguments[i].find(":=");
    if (sign != std::string::npos) {
      takeArgument(command, arguments[i], sign);
    } else if (isLaunchFile(arguments[i])) {
      command.file = ownLaunchFile(arguments[i - 1], arguments[i], command.folder);
      ++launch_files;
    }
  }
  if (launch_files != 1 || command.file.empty()) return std::nullopt;
  return command;
}

void requireHeededLaunchArguments() {
  const std::optional<LaunchCommand> command = launchCommand();
  if (!command) return;
  const std::vector<std::string> known = declaredArguments(command->file);
  for (const auto& [name, value] : command->arguments) {
    requireHeededValue(name, value);
    if (holds(known, name)) continue;
    throw core::InputError("'" + name + ":=" + value + "': " + command->file.filename().string() +
                           " has no argument '" + name + "'; the nearest one is '" +
                           core::nearestName(name, known) + "' (roslaunch --ros-args e2e_cdiff " +
                           command->file.filename().string() + " lists all)");
  }
}

}  // namespace cdiff::node_graph
