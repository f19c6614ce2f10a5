// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/session_files.h"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <stdexcept>

#include "core/clock.h"
#include "core/file.h"
#include "core/output_folder.h"
#include "core/program.h"
#include "core/spelling.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "node_graph/lockstep/node_process.h"
#include "page/result_writer.h"
#include "record/result_folder.h"
#include "ros/ros.h"
#include "suite/seal.h"

namespace cdiff::node_graph {
namespace {

/// Holds the process of the roslaunch whose input was refused.
constexpr const char* kRefusedLaunch = "e2e_cdiff_refused_launch";

std::string textOf(const std::string& key, XmlRpc::XmlRpcValue value) {
  switch (value.getType()) {
    case XmlRpc::XmlRpcValue::TypeString:
      return static_cast<std::string&>(value);
    case XmlRpc::XmlRpcValue::TypeInt:
      return std::to_string(static_cast<int&>(value));
    case XmlRpc::XmlRpcValue::TypeDouble:
      return core::formatNumber(static_cast<double&>(value));
    case XmlRpc::XmlRpcValue::TypeBoolean:
      return static_cast<bool&>(value) ? "true" : "false";
    default:
      throw core::InputError("parameter ~" + key + " is neither a text, a number nor a flag");
  }
}

}  // namespace

Parameters Parameters::ofThisNode() {
  const Parameters parameters = of(ros::this_node::getName());
  if (parameters.empty() && !ros::master::check())
    throw std::runtime_error("the ROS master at " + ros::master::getURI() +
                             " does not answer any more");
  return parameters;
}

Parameters Parameters::ofNode(const std::string& node) { return of(ros::names::resolve(node)); }

Parameters Parameters::of(const std::string& full_name) {
  std::map<std::string, std::string> values;
  XmlRpc::XmlRpcValue all;
  if (!ros::param::get(full_name, all)) return Parameters(values);
  if (all.getType() != XmlRpc::XmlRpcValue::TypeStruct) return Parameters(values);
  for (auto& [key, value] : all) values[key] = textOf(key, value);
  return Parameters(values);
}

void Parameters::requireKnown(const std::vector<std::string>& known) const {
  for (const auto& [key, value] : values_) {
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    throw core::InputError("unknown parameter ~" + key + "; the nearest known one is ~" +
                           core::nearestName(key, known));
  }
}

std::string Parameters::text(const std::string& key) const {
  const auto found = values_.find(key);
  return found == values_.end() ? std::string() : found->second;
}

double Parameters::positive(const std::string& key, double otherwise) const {
  const std::string value = text(key);
  if (value.empty()) return otherwise;
  const std::optional<double> number = core::parseNumber(value);
  if (!number || *number <= 0.0) {
    throw core::InputError("parameter ~" + key + " is '" + value + "'; expected a number above 0");
  }
  return *number;
}

bool Parameters::flag(const std::string& key, bool otherwise) const {
  const std::string value = text(key);
  if (value.empty()) return otherwise;
  if (value != "true" && value != "false") {
    throw core::InputError("parameter ~" + key + " is '" + value + "'; expected true or false");
  }
  return value == "true";
}

void noteRefusal() { ros::param::set(kRefusedLaunch, static_cast<int>(::getppid())); }

bool takeRefusal() {
  int launch = 0;
  if (!ros::param::get(kRefusedLaunch, launch) || launch != ::getppid()) return false;
  ros::param::del(kRefusedLaunch);
  return true;
}

Parameters launchParameters() {
  std::optional<LaunchCommand> command = launchCommand();
  if (!command) return Parameters({});
  command->arguments.emplace("folder", command->folder.string());
  return Parameters(command->arguments);
}

session::SessionRequest sessionRequest(const Parameters& parameters) {
  session::SessionRequest request;
  request.scenario = parameters.text("scenario");
  request.bench2drive = parameters.text("bench2drive");
  request.route = parameters.text("route");
  request.network = parameters.text("network");
  request.mode = parameters.text("mode");
  request.ego_planner = parameters.text("ego_planner");
  request.cbv_planner = parameters.text("cbv_planner");
  request.seed = parameters.text("seed");
  request.video = parameters.flag("video", false);
  request.set = core::splitText(parameters.text("set"), ' ');
  request.set_source = "parameter ~set";
  if (request.scenario.empty() && request.bench2drive.empty())
    request.scenario = "crossing_left_turn";
  return request;
}

session::ScenarioOptions requestedScenario(const Parameters& parameters) {
  const session::SessionRequest request = sessionRequest(parameters);
  suite::requireOpen(request.scenario);
  return session::resolveRequest(request);
}

namespace {

namespace fs = std::filesystem;

fs::path ownFolder(const session::ScenarioOptions& options) {
  const char* home = std::getenv("HOME");
  const fs::path base = home != nullptr ? fs::path(home) : core::temporaryFolder();
  return base / "e2e_cdiff_results" /
         (core::fileName(options.name) + "_seed" + std::to_string(options.seed) + "_" +
          core::timeForFileName());
}

/// Whether a file is there that is younger than the launch of this session.
bool writtenByThisLaunch(const fs::path& path) {
  struct stat file {};
  if (::stat(path.c_str(), &file) != 0) return false;
  const double written =
      static_cast<double>(file.st_mtim.tv_sec) + 1e-9 * static_cast<double>(file.st_mtim.tv_nsec);
  return written >= launchTime().value_or(0.0);
}

/// The requested folder; empty when none was requested.
fs::path askedFolder(const Parameters& parameters) {
  const std::string text = parameters.text("results");
  return text.empty() ? fs::path() : fs::absolute(text).lexically_normal();
}

int writeUnstarted(const session::ScenarioOptions& options, const fs::path& folder,
                   traffic::SessionStatus status, const traffic::Fault& fault) {
  const session::SessionSetup setup(options);
  const bool deterministic = options.real_time_factor == 0.0;
  page::ResultWriter writer(setup, {kDeployment, "unknown", deterministic}, folder);
  traffic::TrafficSnapshot snapshot;
  snapshot.status = status;
  snapshot.faults.push_back(fault);
  session::TickRecord record;
  record.snapshot = &snapshot;
  writer.observe(record);
  writer.finish(0.0);
  std::cout << writer.table() << std::flush;
  return writer.exitCode();
}

}  // namespace

fs::path resultFolder(const std::string& given, const session::ScenarioOptions& options) {
  return fs::absolute(given.empty() ? ownFolder(options) : fs::path(given)).lexically_normal();
}

void enterFolder(const std::string& folder) {
  std::error_code error;
  if (!folder.empty()) fs::current_path(folder, error);
  if (error) throw core::InputError("parameter ~folder is '" + folder + "': " + error.message());
}

int writeUnstartedResult(const Parameters& parameters, traffic::SessionStatus status,
                         const traffic::Fault& fault) {
  fs::path folder;
  try {
    enterFolder(parameters.text("folder"));
    folder = askedFolder(parameters);
    const bool replaces = status == traffic::SessionStatus::kInterrupted;
    if (!folder.empty() && !replaces && writtenByThisLaunch(folder / "exit_code"))
      return core::ExitCode::kRunTimeError;
    requireKnownLaunchArguments();  // else it would be the result of another session than was meant
    const auto options = requestedScenario(parameters);
    folder = resultFolder(parameters.text("results"), options);
    const bool overwrite =
        parameters.flag("overwrite", false) || writtenByThisLaunch(folder / "session.yaml");
    const record::ResultFolder claimed(folder, kDeployment, overwrite);
    const int exit_code = writeUnstarted(options, folder, status, fault);
    writeExitCode(folder, exit_code);
    return exit_code;
  } catch (const core::InputError& error) {
    std::cerr << error.what() << std::endl;
    writeRefusal(folder);
    return core::ExitCode::kBadInput;
  }
}

void writeExitCode(const fs::path& folder, int exit_code) {
  const std::string text = std::to_string(exit_code) + "\n";
  const char* also = std::getenv(kExitCodeVariable);
  if (also != nullptr && *also != '\0') core::writeFileAtomically(also, text);
  if (!folder.empty()) core::writeOwnFile(folder / "exit_code", text);
}

void writeRefusal(const fs::path& folder) {
  writeExitCode({}, core::ExitCode::kBadInput);
  if (folder.empty()) return;
  try {
    record::requireFreeFolder(folder, false);
    const core::FolderLock lock(folder, kDeployment);
    writeExitCode(folder, core::ExitCode::kBadInput);
  } catch (const core::InputError&) {
    // Another session's folder, or none can be made: what is wrong is printed in any case.
  }
}

}  // namespace cdiff::node_graph
