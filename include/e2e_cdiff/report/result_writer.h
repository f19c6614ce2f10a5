// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Writes a session's result folder: session.yaml, trace.csv, summary.json, junit.xml, report.html. Observes the session and keeps nothing of
/// wall-clock time in the trace, so the same session gives the same trace in every deployment.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "e2e_cdiff/scenario/session_observer.h"
#include "e2e_cdiff/scenario/session_setup.h"

namespace cdiff::report {

/// Facts about the run that are not in the scenario.
struct RunFacts {
  std::string deployment;            ///< "cdiff run" or "roslaunch"
  std::string simulator_version;     ///< "SUMO 1.15.0"
  bool deterministic = true;         ///< false when wall-clock time replaced an answer
};

/// What the verdict says.
struct Verdict {
  bool passed = false;
  std::vector<std::string> failures; ///< one sentence per rule that was not met
};

class ResultWriter : public scenario::SessionObserver {
 public:
  /// Makes the folder (and its parents) and opens the trace. `setup` must outlive the writer.
  ResultWriter(const scenario::SessionSetup& setup, const RunFacts& facts, const std::filesystem::path& folder);
  ~ResultWriter() override;

  void observe(const scenario::TickRecord& record) override;
  /// Writes everything that is still missing. Call once, whatever the session ended with; files are whole or absent.
  Verdict finish(double wall_seconds);
  /// The table that a terminal shows: the main figures, the verdict, the paths.
  std::string table() const;
  /// Exit code of `cdiff` for this session: 0 passed, 1 verdict failed, 2 error, 130 interrupted.
  int exitCode() const;

 private:
  class Record;
  std::unique_ptr<Record> record_;
};

}  // namespace cdiff::report
