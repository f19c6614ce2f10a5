// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "page/result_writer.h"

#include <functional>
#include <optional>

#include "core/disk_memory.h"
#include "core/output_folder.h"
#include "core/stage_times.h"
#include "e2e_cdiff/core/exceptions.h"
#include "page/html_report.h"
#include "record/junit.h"
#include "record/logs/plan_log.h"
#include "record/logs/size_log.h"
#include "record/result_folder.h"
#include "record/session_text.h"
#include "record/session_yaml.h"
#include "record/summary.h"
#include "traffic/shown_fault.h"

namespace cdiff::page {
namespace {

namespace fs = std::filesystem;

/// What summary and verdict take on the disk from the start [bytes]; some 12,000 and 1,000 are
/// usual.
constexpr std::size_t kSummaryRoom = 1 << 16;
constexpr std::size_t kJunitRoom = 1 << 14;
/// From one time that the memory is settled to the next.
constexpr std::uint64_t kTicksToSettle = 1000;

}  // namespace

/// What is gathered while the session runs.
class ResultWriter::Record {
 public:
  Record(const session::SessionSetup& setup, const record::RunFacts& facts, const fs::path& folder)
      : folder_(folder),
        summary_(folder_, "summary.json", kSummaryRoom),
        junit_(folder_, "junit.xml", kJunitRoom),
        trace_(std::make_unique<record::TraceWriter>(folder_)),
        memory_(folder_.path()),
        metrics_(setup.metricsOptions(), setup.drivableArea(), setup.egoRoute(), &memory_),
        timeline_(setup.options().simulation_step, &memory_),
        cbv_(&memory_),
        approaches_(&memory_),
        plans_(setup.options().simulation_step, &memory_),
        guidance_(&memory_),
        front_views_(setup),
        hold_ups_(setup),
        sizes_(&memory_),
        latencies_(&memory_),
        late_(&memory_),
        result_{setup,        timeline_, cbv_,      approaches_, plans_, guidance_,
                front_views_, driving_,  hold_ups_, steering_,   facts} {
    folder_.remove({"session.yaml", "trace.csv", "plans.csv", "vehicles.csv", "summary.json",
                    "junit.xml", "report.html"});
    folder_.write("session.yaml", record::sessionYaml(setup, facts));
  }

  void observe(const session::TickRecord& record) {
    const traffic::TrafficSnapshot& snapshot = *record.snapshot;
    result_.status = snapshot.status;
    for (const traffic::Fault& fault : snapshot.faults)
      result_.faults.push_back(traffic::shownFault(fault));
    latencies_.observe(record.latencies);
    late_.observe(record.timings);
    if (last_tick_ && snapshot.tick <= *last_tick_)
      return;  // the same tick again, ended from outside
    last_tick_ = snapshot.tick;
    result_.simulated_seconds = snapshot.time;
    measure(record);
    timeline_.observe(snapshot);
    if (record.actions != nullptr) {
      timeline_.observeAttention(snapshot, *record.actions);
      timeline_.observePerception(snapshot, *record.actions);
    }
    if (record.selection != nullptr) cbv_.observe(snapshot, *record.selection);
    approaches_.observe(record);
    plans_.observe(record);
    guidance_.observe(record);
    front_views_.observe(snapshot);
    driving_.observe(snapshot);
    hold_ups_.observe(snapshot);
    steering_.observe(record);
    sizes_.observe(snapshot);
    if (snapshot.tick % kTicksToSettle == 0) memory_.settle();
    writeTrace(snapshot);
  }

  const record::Verdict& finish(double wall_seconds) {
    if (finished_) return result_.verdict;
    finished_ = true;
    result_.wall_seconds = wall_seconds;
    attempt([&] {
      if (trace_) result_.trace_sha256 = trace_->finish();
    });
    attempt([&] { saveFromDeletion(); });
    for (const record::Approach& approach : approaches_.approaches())
      timeline_.addEvent(approach.event());
    completeResult();
    attempt([&] { folder_.write("plans.csv", record::plansCsv(plans_)); });
    attempt([&] { folder_.write("vehicles.csv", sizes_.csv()); });
    attempt([&] { folder_.write("report.html", htmlReport(result_)); });
    attempt([&] {
      junit_.append(record::junitXml(result_));
      junit_.finish();
    });
    summary_.append(record::summaryJson(result_));
    summary_.finish();
    return result_.verdict;
  }

  /// The result lacks something from now on: it is one of a session that broke.
  void fail(const std::string& text) {
    if (failure_.empty()) failure_ = text;
    result_.status = traffic::SessionStatus::kError;
    result_.faults.push_back({last_tick_.value_or(0), "result folder", text});
    if (finished_) decide();
  }
  const std::string& failure() const { return failure_; }

  /// First, since the last one is why a session ended.
  void recordFault(const traffic::Fault& fault) {
    result_.faults.insert(result_.faults.begin(), traffic::shownFault(fault));
  }

  const metrics::TickMeasures& tickMeasures() const { return tick_measures_; }
  /// Reads all samples of the session so far.
  metrics::SessionMeasures measures() {
    metrics::SessionMeasures measures = metrics_.measures();
    memory_.settle();
    return measures;
  }

  fs::path folder() const { return folder_.path(); }
  const record::SessionResult& result() const { return result_; }

 private:
  void measure(const session::TickRecord& record) {
    const core::TimedStage stage("metrics");
    tick_measures_ = metrics_.observe(*record.snapshot, record.selection);
  }

  /// Gives the trace's room back when it cannot be written.
  void writeTrace(const traffic::TrafficSnapshot& snapshot) {
    if (!trace_) return;
    try {
      trace_->write(snapshot);
    } catch (const core::InputError& error) {
      trace_.reset();
      fail(error.what());
      throw core::Error(error.what());
    }
  }

  /// Writes again what was written before the folder was deleted, and says that it was.
  void saveFromDeletion() {
    const fs::path folder = folder_.path();
    if (!folder_.wasDeleted()) return;
    folder_.write("session.yaml", record::sessionYaml(result_.setup, result_.facts));
    throw core::InputError("the result folder '" + folder.string() +
                           "' was deleted while the session ran; it was made again with what "
                           "could be saved");
  }

  void attempt(const std::function<void()>& writing) {
    try {
      writing();
    } catch (const core::InputError& error) {
      fail(error.what());
    }
  }

  void completeResult() {
    if (!failure_.empty()) result_.status = traffic::SessionStatus::kError;
    if (result_.status == traffic::SessionStatus::kRunning) {
      result_.status = traffic::SessionStatus::kError;
      result_.faults.push_back({last_tick_.value_or(0), "session",
                                "the record ends while the session was still running"});
    }
    result_.measures = metrics_.measures();
    std::vector<traffic::Fault> faults;
    for (const traffic::Fault& fault : result_.measures.faults)
      faults.push_back(traffic::shownFault(fault));
    result_.faults.insert(result_.faults.begin(), faults.begin(), faults.end());
    result_.latencies = latencies_.summaries();
    result_.late = late_.counts();
    decide();
  }

  void decide() {
    result_.verdict = record::judge(result_.setup.options(), result_.status, result_.measures,
                                    result_.faults, steering_.records());
  }

  core::OutputFolder folder_;
  core::PendingFile summary_;
  core::PendingFile junit_;
  std::unique_ptr<record::TraceWriter> trace_;  ///< null once it could not be written
  core::DiskMemory memory_;  ///< of most that grows with the session; not of perceptions
  metrics::SessionMetrics metrics_;
  metrics::TickMeasures tick_measures_;
  record::Timeline timeline_;
  record::CbvLog cbv_;
  record::ApproachLog approaches_;
  record::PlanLog plans_;
  record::GuidanceLog guidance_;
  record::FrontViewLog front_views_;
  record::DrivingLog driving_;
  record::HoldUpLog hold_ups_;
  record::SteeringLog steering_;
  record::SizeLog sizes_;
  record::LatencyLog latencies_;
  record::LateLog late_;
  record::SessionResult result_;
  std::optional<std::uint64_t> last_tick_;
  std::string failure_;
  bool finished_ = false;
};

ResultWriter::ResultWriter(const session::SessionSetup& setup, const record::RunFacts& facts,
                           const fs::path& folder)
    : record_(std::make_unique<Record>(setup, facts, folder)) {}

ResultWriter::~ResultWriter() = default;

void ResultWriter::observe(const session::TickRecord& record) { record_->observe(record); }

record::Verdict ResultWriter::finish(double wall_seconds) { return record_->finish(wall_seconds); }

void ResultWriter::recordFault(const traffic::Fault& fault) { record_->recordFault(fault); }

const std::string& ResultWriter::failure() const { return record_->failure(); }

std::string ResultWriter::table() const { return table(record_->folder()); }

fs::path ResultWriter::folder() const { return record_->folder(); }

std::string ResultWriter::table(const fs::path& folder) const {
  return record::sessionTable(record_->result(), folder);
}

int ResultWriter::exitCode() const {
  const record::SessionResult& result = record_->result();
  const record::Outcome outcome = result.verdict.outcome;
  const bool bad_input = outcome == record::Outcome::kError && !result.faults.empty() &&
                         result.faults.back().source == traffic::kInputFault;
  return bad_input ? 3 : exitCodeOf(outcome);
}

const metrics::TickMeasures& ResultWriter::tickMeasures() const { return record_->tickMeasures(); }

metrics::SessionMeasures ResultWriter::measures() const { return record_->measures(); }

const record::SessionResult& ResultWriter::result() const { return record_->result(); }

}  // namespace cdiff::page
