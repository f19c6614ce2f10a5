// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/ros/session_files.h"

#include <sys/stat.h>

#include <cstdlib>
#include <ctime>
#include <iostream>

#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/core/file.h"
#include "e2e_cdiff/core/text.h"
#include "e2e_cdiff/report/session_video.h"
#include "e2e_cdiff/ros/launched_nodes.h"

namespace cdiff::ros {
namespace {

namespace fs = std::filesystem;

std::string timeText() {
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  localtime_r(&now, &local);
  char text[32];
  std::strftime(text, sizeof(text), "%Y%m%d_%H%M%S", &local);
  return text;
}

fs::path ownFolder(const scenario::ScenarioOptions& options) {
  const char* home = std::getenv("HOME");
  const fs::path base = home != nullptr ? fs::path(home) : core::temporaryFolder();
  return base / "e2e_cdiff_results" /
         (core::fileName(options.name) + "_seed" + std::to_string(options.seed) + "_" + timeText());
}

/// Whether a file exit_code is there that is younger than the launch of this session.
bool hasResult(const fs::path& folder) {
  struct stat file {};
  if (::stat((folder / "exit_code").c_str(), &file) != 0) return false;
  const double written =
      static_cast<double>(file.st_mtim.tv_sec) + 1e-9 * static_cast<double>(file.st_mtim.tv_nsec);
  return written >= launchTime().value_or(0.0);
}

/// The folder that was asked for; empty when none was.
fs::path askedFolder(const Parameters& parameters) {
  const std::string text = parameters.text("results");
  return text.empty() ? fs::path() : fs::absolute(text).lexically_normal();
}

int writeUnstarted(const scenario::ScenarioOptions& options, const fs::path& folder,
                   traffic::SessionStatus status, const traffic::Fault& fault) {
  const scenario::SessionSetup setup(options);
  const bool deterministic = options.real_time_factor == 0.0;
  report::ResultWriter writer(setup, {kDeployment, "unknown", deterministic}, folder);
  traffic::TrafficSnapshot snapshot;
  snapshot.status = status;
  snapshot.faults.push_back(fault);
  scenario::TickRecord record;
  record.snapshot = &snapshot;
  writer.observe(record);
  writer.finish(0.0);
  std::cout << writer.table() << std::flush;
  return writer.exitCode();
}

}  // namespace

void enterFolder(const std::string& folder) {
  std::error_code error;
  if (!folder.empty()) fs::current_path(folder, error);
  if (error) throw core::InputError("parameter ~folder is '" + folder + "': " + error.message());
}

int writeUnstartedResult(const Parameters& parameters, traffic::SessionStatus status,
                         const traffic::Fault& fault) {
  fs::path folder;
  int exit_code = 3;
  try {
    enterFolder(parameters.text("folder"));
    folder = askedFolder(parameters);
    if (!folder.empty() && hasResult(folder)) return 2;
    const auto options = scenario::resolveRequest(sessionRequest(parameters));
    folder = makeResultFolder(parameters.text("results"), options);
    exit_code = writeUnstarted(options, folder, status, fault);
  } catch (const core::InputError& error) {
    std::cerr << error.what() << std::endl;
  }
  if (!folder.empty()) writeExitCode(folder, exit_code);
  return exit_code;
}

fs::path makeResultFolder(const std::string& given, const scenario::ScenarioOptions& options) {
  const fs::path folder =
      fs::absolute(given.empty() ? ownFolder(options) : fs::path(given)).lexically_normal();
  std::error_code error;
  fs::create_directories(folder, error);
  if (error)
    throw core::InputError("cannot make the result folder '" + folder.string() +
                           "': " + error.message());
  for (const char* name : {"session.bag", "session.bag.active", "exit_code", report::kVideoFile})
    fs::remove(folder / name, error);
  return folder;
}

void writeExitCode(const fs::path& folder, int exit_code) {
  core::writeFileAtomically(folder / "exit_code", std::to_string(exit_code) + "\n");
}

ReserveResult::ReserveResult(const scenario::SessionSetup& setup, const report::RunFacts& facts,
                             const fs::path& results)
    : results_(results),
      folder_(results / ".reserve"),
      writer_(std::make_unique<report::ResultWriter>(setup, facts, folder_)) {}

ReserveResult::~ReserveResult() {
  writer_.reset();
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

void ReserveResult::adopt(double wall_seconds) {
  if (fs::exists(results_ / "exit_code")) return;
  writer_->finish(wall_seconds);
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(results_, ignored)) {
    const std::string name = entry.path().filename().string();
    if (name.find(".tmp.") != std::string::npos) fs::remove(entry.path(), ignored);
  }
  for (const auto& entry : fs::directory_iterator(folder_)) {
    fs::rename(entry.path(), results_ / entry.path().filename());
  }
  writeExitCode(results_, writer_->exitCode());
}

}  // namespace cdiff::ros
