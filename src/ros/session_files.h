// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "page/result_writer.h"
#include "record/result_folder.h"
#include "ros/parameters.h"

namespace cdiff::ros {

// Where a session of the node graph puts its files, and the result folder that the traffic
// simulator writes when the metrics node cannot: a session always leaves a result that can be
// read.

/// "roslaunch", as results name this deployment.
inline constexpr const char* kDeployment = "roslaunch";

/// Absolute result folder: the one given, else HOME/e2e_cdiff_results/SCENARIO_seedN_TIME.
std::filesystem::path resultFolder(const std::string& given,
                                   const session::ScenarioOptions& options);

/// Names a file in the environment that gets the exit code too (scripts/session reads it).
inline constexpr const char* kExitCodeVariable = "E2E_CDIFF_EXIT_CODE_FILE";

/// Writes the session's exit code (as `cdiff`'s) to the file exit_code, because roslaunch itself
/// exits with 0 whatever happened.
void writeExitCode(const std::filesystem::path& folder, int exit_code);

/// The exit code of a session that bad input kept from starting; a folder in use, or with an
/// earlier result, is not touched. `folder` may be empty.
void writeRefusal(const std::filesystem::path& folder);

/// Relative paths in parameters are meant from where the user started the session; empty: from
/// here. Throws InputError when there is no such folder.
void enterFolder(const std::string& folder);

/// Writes the result of a session that ended before its first snapshot, which its simulator was to
/// run with these parameters, and returns the exit code of `cdiff`. A result (file exit_code) that
/// this launch has already written stays. Bad input is reported in one line, with exit code 3.
int writeUnstartedResult(const Parameters& parameters, traffic::SessionStatus status,
                         const traffic::Fault& fault);

/// The session's result as the simulator itself saw it, kept aside (RESULTS/.reserve) while the
/// metrics node writes the real one; put in place when that node cannot finish.
class ReserveResult {
 public:
  /// `setup` must outlive the object.
  ReserveResult(const session::SessionSetup& setup, const record::RunFacts& facts,
                const std::filesystem::path& results);
  /// Takes the folder away.
  ~ReserveResult();
  ReserveResult(const ReserveResult&) = delete;
  ReserveResult& operator=(const ReserveResult&) = delete;

  /// On a full disk it goes on without a trace.
  void observe(const session::TickRecord& record);
  /// Finishes the result, moves its files into the result folder, prints its table and writes the
  /// exit code; nothing where the metrics node has written its own meanwhile (file exit_code).
  void adopt(double wall_seconds);

 private:
  std::filesystem::path results_;
  std::filesystem::path folder_;
  std::unique_ptr<page::ResultWriter> writer_;
};

}  // namespace cdiff::ros
