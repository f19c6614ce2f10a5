// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/result_reserve.h"

#include <iostream>

#include "e2e_cdiff/core/exceptions.h"
#include "node_graph/bags/replay.h"
#include "node_graph/lockstep/tick_record.h"
#include "node_graph/session_files.h"
#include "page/result_writer.h"

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
  try {
    results_.remove({kReserve});
  } catch (const core::InputError&) {
    // It stays on the record, and goes with the next session.
  }
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
  writeExitCode(results_.path(), exit_code);
  return true;
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

}  // namespace cdiff::node_graph
