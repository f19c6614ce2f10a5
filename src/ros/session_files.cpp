// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "ros/session_files.h"

#include <sys/stat.h>

#include <cstdlib>
#include <iostream>

#include "core/file.h"
#include "core/program.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "ros/lockstep/launched_nodes.h"

namespace cdiff::ros {
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
    if (!folder.empty() && writtenByThisLaunch(folder / "exit_code"))
      return core::ExitCode::kRunTimeError;
    requireKnownLaunchArguments();  // else it would be the result of another session than was meant
    const auto options = session::resolveRequest(sessionRequest(parameters));
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
  if (!folder.empty()) core::writeFileAtomically(folder / "exit_code", text);
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

ReserveResult::ReserveResult(const session::SessionSetup& setup, const record::RunFacts& facts,
                             const fs::path& results)
    : results_(results),
      folder_(results / ".reserve"),
      writer_(std::make_unique<page::ResultWriter>(setup, facts, folder_)) {}

ReserveResult::~ReserveResult() {
  writer_.reset();
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

void ReserveResult::observe(const session::TickRecord& record) {
  try {
    writer_->observe(record);
  } catch (const core::Error&) {
    // The writer has noted it, and the result will say so.
  }
}

void ReserveResult::adopt(double wall_seconds) {
  if (fs::exists(results_ / "exit_code")) return;
  writer_->finish(wall_seconds);
  core::removeTemporaries(results_);
  for (const auto& entry : fs::directory_iterator(folder_)) {
    fs::rename(entry.path(), results_ / entry.path().filename());
  }
  std::cout << writer_->table(results_) << std::flush;
  writeExitCode(results_, writer_->exitCode());
}

}  // namespace cdiff::ros
