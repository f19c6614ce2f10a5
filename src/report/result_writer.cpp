// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/report/result_writer.h"

#include <optional>
#include <system_error>

#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/core/file.h"
#include "e2e_cdiff/metrics/session_metrics.h"
#include "e2e_cdiff/report/html_report.h"
#include "e2e_cdiff/report/junit.h"
#include "e2e_cdiff/report/plan_file.h"
#include "e2e_cdiff/report/session_table.h"
#include "e2e_cdiff/report/session_yaml.h"
#include "e2e_cdiff/report/summary.h"
#include "e2e_cdiff/report/trace_writer.h"

namespace cdiff::report {
namespace {

namespace fs = std::filesystem;

/// Makes the folder and takes away the files of an earlier session, so that none can be mistaken
/// for this one's.
fs::path preparedFolder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) {
    throw core::InputError("cannot make the result folder '" + folder.string() +
                           "': " + error.message());
  }
  for (const char* name :
       {"session.yaml", "trace.csv", "plans.csv", "summary.json", "junit.xml", "report.html"}) {
    fs::remove(folder / name, error);
    if (error) {
      throw core::InputError("cannot replace '" + (folder / name).string() +
                             "': " + error.message());
    }
  }
  return folder;
}

}  // namespace

/// What is gathered while the session runs.
class ResultWriter::Record {
 public:
  Record(const scenario::SessionSetup& setup, const RunFacts& facts, const fs::path& folder)
      : folder_(preparedFolder(folder)),
        trace_(folder_ / "trace.csv"),
        metrics_(setup.metricsOptions(), setup.drivableArea(), setup.egoRoute()),
        timeline_(setup.options().simulation_step),
        plans_(setup.options().simulation_step),
        front_views_(setup),
        result_{setup,     timeline_,    cbv_,     approaches_, plans_,
                guidance_, front_views_, driving_, facts} {
    core::writeFileAtomically(folder_ / "session.yaml", sessionYaml(setup, facts));
  }

  void observe(const scenario::TickRecord& record) {
    const traffic::TrafficSnapshot& snapshot = *record.snapshot;
    result_.status = snapshot.status;
    result_.faults.insert(result_.faults.end(), snapshot.faults.begin(), snapshot.faults.end());
    latencies_.observe(record.latencies);
    late_.observe(record.timings);
    if (last_tick_ && snapshot.tick <= *last_tick_)
      return;  // the same tick again, ended from outside
    last_tick_ = snapshot.tick;
    result_.simulated_seconds = snapshot.time;
    trace_.write(snapshot);
    metrics_.observe(snapshot, record.selection);
    timeline_.observe(snapshot);
    if (record.selection != nullptr) cbv_.observe(snapshot, *record.selection);
    approaches_.observe(record);
    plans_.observe(record);
    guidance_.observe(record);
    front_views_.observe(snapshot);
    driving_.observe(snapshot);
  }

  const Verdict& finish(double wall_seconds) {
    if (finished_) return result_.verdict;
    finished_ = true;
    result_.wall_seconds = wall_seconds;
    completeResult();
    core::writeFileAtomically(folder_ / "plans.csv", plansCsv(plans_));
    core::writeFileAtomically(folder_ / "summary.json", summaryJson(result_));
    core::writeFileAtomically(folder_ / "junit.xml", junitXml(result_));
    core::writeFileAtomically(folder_ / "report.html", htmlReport(result_));
    return result_.verdict;
  }

  const fs::path& folder() const { return folder_; }
  const SessionResult& result() const { return result_; }

 private:
  void completeResult() {
    if (result_.status == traffic::SessionStatus::kRunning) {
      result_.status = traffic::SessionStatus::kError;
      result_.faults.push_back({last_tick_.value_or(0), "session",
                                "the record ends while the session was still running"});
    }
    result_.trace_sha256 = trace_.finish();
    result_.measures = metrics_.measures();
    result_.latencies = latencies_.figures();
    result_.late = late_.figures();
    result_.verdict =
        judge(result_.setup.options(), result_.status, result_.measures, result_.faults);
  }

  fs::path folder_;
  TraceWriter trace_;
  metrics::SessionMetrics metrics_;
  Timeline timeline_;
  CbvLog cbv_;
  ApproachLog approaches_;
  PlanLog plans_;
  GuidanceLog guidance_;
  FrontViewLog front_views_;
  DrivingLog driving_;
  LatencyLog latencies_;
  LateLog late_;
  SessionResult result_;
  std::optional<std::uint64_t> last_tick_;
  bool finished_ = false;
};

ResultWriter::ResultWriter(const scenario::SessionSetup& setup, const RunFacts& facts,
                           const fs::path& folder)
    : record_(std::make_unique<Record>(setup, facts, folder)) {}

ResultWriter::~ResultWriter() = default;

void ResultWriter::observe(const scenario::TickRecord& record) { record_->observe(record); }

Verdict ResultWriter::finish(double wall_seconds) { return record_->finish(wall_seconds); }

std::string ResultWriter::table() const {
  return sessionTable(record_->result(), record_->folder());
}

int ResultWriter::exitCode() const { return exitCodeOf(record_->result().verdict.outcome); }

const SessionResult& ResultWriter::result() const { return record_->result(); }

}  // namespace cdiff::report
