// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Writes a session's result folder: session.yaml, trace.csv, plans.csv, summary.json, junit.xml,
/// report.html. Observes the session and keeps nothing of wall-clock time in the trace, so the same
/// session gives the same trace in every deployment.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "e2e_cdiff/report/session_result.h"
#include "e2e_cdiff/scenario/session_observer.h"
#include "e2e_cdiff/scenario/session_setup.h"

namespace cdiff::report {

class ResultWriter : public scenario::SessionObserver {
 public:
  /// Makes the folder (and its parents), removes what an earlier session left there, writes
  /// session.yaml and opens the trace. `setup` must outlive the writer. Throws InputError naming a
  /// path that cannot be written.
  ResultWriter(const scenario::SessionSetup& setup, const RunFacts& facts,
               const std::filesystem::path& folder);
  ~ResultWriter() override;

  void observe(const scenario::TickRecord& record) override;
  /// Writes everything that is still missing. Call once, whatever the session ended with; files are
  /// whole or absent.
  Verdict finish(double wall_seconds);
  /// The table that a terminal shows: the main figures, the verdict, the paths.
  std::string table() const;
  /// Exit code of `cdiff` for this session (exitCodeOf its outcome).
  int exitCode() const;
  /// What was found; complete after `finish`.
  const SessionResult& result() const;

 private:
  class Record;
  std::unique_ptr<Record> record_;
};

}  // namespace cdiff::report
