// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "metrics/session_metrics.h"
#include "record/session_result.h"
#include "session/session_observer.h"
#include "session/session_setup.h"

namespace cdiff::page {

/// Writes a session's result folder: session.yaml, trace.csv, plans.csv, vehicles.csv,
/// summary.json, junit.xml, report.html. Observes the session and keeps nothing of wall-clock time
/// in the trace, so the same session gives the same trace in every deployment.
class ResultWriter : public session::SessionObserver {
 public:
  /// Makes the folder (and its parents), removes the files that an earlier session made there,
  /// writes session.yaml and opens the trace. `setup` must outlive the writer. Throws InputError
  /// naming a path that cannot be written, or a file there that this program did not make.
  ResultWriter(const session::SessionSetup& setup, const record::RunFacts& facts,
               const std::filesystem::path& folder);
  ~ResultWriter() override;

  /// Throws core::Error once when the trace cannot be written (disk full): its part is removed,
  /// `failure` says why, and what follows is taken without a trace.
  void observe(const session::TickRecord& record) override;
  /// Writes everything that is still missing. Call once, whatever the session ended with; files are
  /// whole or absent. A file that cannot be written makes the status `error`, which the summary
  /// says: its room is taken from the start. Throws InputError when even the summary cannot be
  /// written.
  record::Verdict finish(double wall_seconds);
  /// Something that the session survived and that no snapshot contains. Before `finish`.
  void recordFault(const traffic::Fault& fault);
  /// Why the result is not whole; empty when it is.
  const std::string& failure() const;
  /// Where the result lies now: a folder that was renamed while the session ran is followed.
  std::filesystem::path folder() const;
  /// The table that a terminal shows: the main measures, the verdict, the paths.
  std::string table() const;
  /// The same where the files lie in another folder by now.
  std::string table(const std::filesystem::path& folder) const;
  /// Exit code of `cdiff` for this session: that of its outcome, but 3 when SUMO refused the
  /// session's input meanwhile.
  int exitCode() const;
  /// Measures of the tick observed last, and of the session so far.
  const metrics::TickMeasures& tickMeasures() const;
  metrics::SessionMeasures measures() const;
  /// What was found; complete after `finish`.
  const record::SessionResult& result() const;

 private:
  class Record;
  std::unique_ptr<Record> record_;
};

}  // namespace cdiff::page
