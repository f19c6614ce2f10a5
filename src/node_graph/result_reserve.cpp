// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/result_reserve.h"

#include <algorithm>
#include <chrono>
#include <iostream>
#include <utility>

#include "core/file.h"
#include "e2e_cdiff/core/exceptions.h"
#include "node_graph/bags/replay.h"
#include "node_graph/lockstep/hosted_nodes.h"
#include "node_graph/lockstep/tick_record.h"
#include "node_graph/messages/topics.h"
#include "node_graph/messages/traffic_conversions.h"
#include "node_graph/session_files.h"
#include "page/result_writer.h"
#include "record/result_folder.h"

namespace cdiff::node_graph {
namespace {

namespace fs = std::filesystem;

constexpr const char* kReserve = ".reserve";
constexpr const char* kBag = "session.bag";

/// Goes on where the disk is full: the writer has noted it, and the result will say so.
class ToleratedWriter : public session::SessionObserver {
 public:
  explicit ToleratedWriter(page::ResultWriter& writer) : writer_(writer) {}
  void observe(const session::TickRecord& record) override {
    try {
      writer_.observe(record);
    } catch (const core::Error&) {
    }
  }

 private:
  page::ResultWriter& writer_;
};

void removeIfPossible(core::OutputFolder& results, const std::string& name) {
  try {
    results.remove({name});
  } catch (const core::InputError&) {
    // It stays on the record, and goes with the next session.
  }
}

void removeReserve(core::OutputFolder& results) { removeIfPossible(results, kReserve); }

int finishResult(page::ResultWriter& writer, double wall_seconds) {
  writer.finish(wall_seconds);
  std::cout << writer.table() << std::flush;
  return writer.exitCode();
}

}  // namespace

ResultReserve::ResultReserve(const session::SessionSetup& setup, const msgs::SessionInfo& info)
    : setup_(setup),
      facts_(factsOf(info, setup.options().real_time_factor == 0.0)),
      results_(info.results_folder) {
  const fs::path folder = results_.subfolder(kReserve);
  try {
    bag_ = std::make_unique<BagFile>(
        folder / kBag, setup.options(), [](const std::string& topic) { return "/" + topic; },
        BagFile::Content::kSessionOnly);
    bag_->write(info);
  } catch (const core::InputError& error) {
    giveUp(error.what());
  }
}

ResultReserve::~ResultReserve() {
  bag_.reset();
  removeReserve(results_);
}

void ResultReserve::giveUp(const std::string& why) {
  lost_ = why;
  bag_.reset();
}

void ResultReserve::keep(const msgs::TrafficSnapshot::ConstPtr& snapshot,
                         const TickAnswers& answers) {
  if (!bag_) return;
  TickMessages messages = answers.messages(snapshot->tick);
  messages.add(ChannelId::kTraffic, snapshot);
  try {
    bag_->write(messages);
  } catch (const core::InputError& error) {
    giveUp(error.what());
  }
}

bool ResultReserve::adopt(const msgs::TrafficSnapshot::ConstPtr& end, double wall_seconds) {
  if (fs::exists(results_.path() / "exit_code")) return false;
  keep(end, TickAnswers());
  results_.removeUnfinished();
  try {
    if (bag_) bag_->finish();
  } catch (const core::InputError& error) {
    giveUp(error.what());
  }
  std::unique_ptr<RecordedSession> session;
  try {
    if (bag_)
      session = std::make_unique<RecordedSession>(results_.path() / kReserve / kBag,
                                                  RecordedImages::kAll);
  } catch (const core::InputError& error) {
    giveUp(error.what());
  }
  const int exit_code = session ? replay(*session, wall_seconds) : writeEnd(*end, wall_seconds);
  // A recorder that was ended before the first tick leaves a bag that nobody can use.
  if (end->tick == 0 && !nodeRuns(kRecorderNode))
    removeIfPossible(results_, std::string(kBag) + ".active");
  writeExitCode(results_.path(), exit_code);
  return true;
}

void ResultReserve::handOver(const msgs::TrafficSnapshot::ConstPtr& end) {
  keep(end, TickAnswers());
  try {
    if (bag_) bag_->finish();
  } catch (const core::InputError&) {
    // On a full disk. What is there may still be read.
  }
}

int ResultReserve::replay(RecordedSession& session, double wall_seconds) {
  page::ResultWriter writer(session.setup(), facts_, results_.path());
  ToleratedWriter tolerated(writer);
  showTicks(session, {&tolerated});
  return finishResult(writer, wall_seconds);
}

int ResultReserve::writeEnd(const msgs::TrafficSnapshot& end, double wall_seconds) {
  page::ResultWriter writer(setup_, facts_, results_.path());
  ToleratedWriter tolerated(writer);
  tolerated.observe(TickRecordView(end, TickAnswers(), setup_.network()).record());
  writer.recordFault({end.tick, "result folder", "the ticks before the end are lost: " + lost_});
  return finishResult(writer, wall_seconds);
}

void removeReserveOf(const fs::path& results) {
  core::OutputFolder folder(results);
  removeReserve(folder);
}

ProcessReserve::ProcessReserve(const session::SessionSetup& setup, const fs::path& results,
                               const BagOrigin& origin)
    : results_(results),
      bag_(std::make_unique<SessionBagWriter>(setup, results_.subfolder(kReserve) / kBag, origin,
                                              BagFile::Content::kSessionOnly)) {}

ProcessReserve::~ProcessReserve() {
  bag_.reset();
  removeReserve(results_);
}

void ProcessReserve::observe(const session::TickRecord& record) {
  if (!bag_) return;
  try {
    bag_->observe(record);
  } catch (const core::InputError&) {
    bag_.reset();
  }
}

namespace {

/// Takes the ticks of a reserve without the faults of its bag, which ends where its process did.
class AbandonedTicks : public session::SessionObserver {
 public:
  explicit AbandonedTicks(page::ResultWriter& writer) : writer_(writer) {}

  void observe(const session::TickRecord& record) override {
    traffic::TrafficSnapshot snapshot = *record.snapshot;
    const auto of_bag = [](const traffic::Fault& fault) { return fault.source == kBagSource; };
    snapshot.faults.erase(std::remove_if(snapshot.faults.begin(), snapshot.faults.end(), of_bag),
                          snapshot.faults.end());
    session::TickRecord shown = record;
    shown.snapshot = &snapshot;
    writer_.observe(shown);
    last_ = std::move(snapshot);
  }

  /// The last tick once more, with the session's end.
  void end(const AbandonedSession& session) {
    last_.status = session.status;
    last_.faults = {{last_.tick, session.source, session.text}};
    session::TickRecord record;
    record.snapshot = &last_;
    writer_.observe(record);
  }

 private:
  ToleratedWriter writer_;
  traffic::TrafficSnapshot last_;
};

/// What a simulator left: whole, or as it was written when its process ended.
std::optional<fs::path> reservedBag(const fs::path& results) {
  for (const std::string& name : {std::string(kBag), std::string(kBag) + ".active"}) {
    const fs::path bag = results / kReserve / name;
    std::error_code none;
    if (fs::is_regular_file(bag, none)) return bag;
  }
  return std::nullopt;
}

/// nullptr where nothing of it can be read.
std::unique_ptr<RecordedSession> readableSession(const fs::path& bag) {
  try {
    return std::make_unique<RecordedSession>(bag, RecordedImages::kAll);
  } catch (const core::InputError&) {
    return nullptr;
  }
}

/// [s] of wall time from the beginning of a result to the last tick in its reserve; 0 where the
/// metrics node had not begun.
double drivingTime(const fs::path& results, const fs::path& bag) {
  std::error_code none;
  const auto begin = fs::last_write_time(results / "session.yaml", none);
  if (none) return 0.0;
  return std::max(0.0, std::chrono::duration<double>(fs::last_write_time(bag) - begin).count());
}

/// A snapshot as it was recorded; the end that a recording lacks is this one.
msgs::TrafficSnapshot endedBy(msgs::TrafficSnapshot snapshot, traffic::SessionStatus status,
                              const traffic::Fault& fault) {
  const bool cut_off = snapshot.status == msgs::TrafficSnapshot::INTERRUPTED &&
                       !snapshot.faults.empty() && snapshot.faults.back().source == kBagSource;
  if (!cut_off) return snapshot;
  traffic::TrafficSnapshot end = fromMsg(snapshot);
  end.status = status;
  end.faults.push_back({end.tick, fault.source, fault.text});
  msgs::TrafficSnapshot message = node_graph::toMsg(end);
  message.late_answers = snapshot.late_answers;
  return message;
}

}  // namespace

namespace {

/// Keeps the trace of a session whose ticks are nowhere else; whether there is one.
bool keepCutOffTrace(core::OutputFolder& folder) {
  const fs::path trace = folder.path() / "trace.csv.part";
  if (!core::isFile(trace)) return false;
  fs::rename(trace, folder.claim(record::kCutOffTrace));
  return true;
}

}  // namespace

std::string writeAbandonedResult(const session::SessionSetup& setup, const fs::path& results,
                                 const AbandonedSession& session) {
  core::OutputFolder folder(results);
  const bool reserved = core::OutputFolder::lists(results, kReserve);
  const bool has_trace = !reserved && keepCutOffTrace(folder);
  folder.removeUnfinished();
  const auto bag = reserved ? reservedBag(results) : std::nullopt;
  const auto recorded = bag ? readableSession(*bag) : nullptr;
  const std::string simulator = recorded ? recorded->info().simulator_version : "unknown";
  page::ResultWriter writer(setup, {"cdiff run", simulator, true}, results);
  AbandonedTicks ticks(writer);
  if (recorded) showTicks(*recorded, {&ticks});
  AbandonedSession end = session;
  if (has_trace) end.text += std::string("; ") + record::kCutOffTrace + " has its ticks until then";
  ticks.end(end);
  writer.finish(session.wall_seconds);
  removeReserve(folder);
  return writer.table();
}

std::optional<int> writeReservedResult(const fs::path& results, traffic::SessionStatus status,
                                       const traffic::Fault& fault) {
  const std::optional<fs::path> bag = reservedBag(results);
  if (!bag) return std::nullopt;
  const double wall_seconds = drivingTime(results, *bag);
  core::OutputFolder folder(results, "scripts/session");
  const auto session = readableSession(*bag);
  auto message = session ? session->next() : nullptr;
  if (!message) return std::nullopt;
  folder.removeUnfinished();
  const bool deterministic = session->setup().options().real_time_factor == 0.0;
  page::ResultWriter writer(session->setup(), factsOf(session->info(), deterministic), results);
  ToleratedWriter tolerated(writer);
  const std::string plugins = pluginsOf(fault.source, session->setup().options());
  const traffic::Fault named{fault.tick, fault.source, fault.text + plugins};
  for (; message; message = session->next()) {
    const auto snapshot = endedBy(*message, status, named);
    tolerated.observe(
        TickRecordView(snapshot, session->answers(), session->setup().network()).record());
  }
  const int exit_code = finishResult(writer, wall_seconds);
  removeReserve(folder);
  return exit_code;
}

}  // namespace cdiff::node_graph
