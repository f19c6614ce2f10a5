// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "run_session.h"

#include <atomic>
#include <chrono>
#include <functional>
#include <iostream>
#include <memory>

#include "commands.h"
#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/core/program.h"
#include "e2e_cdiff/report/result_folder.h"
#include "e2e_cdiff/report/result_writer.h"
#include "e2e_cdiff/report/session_table.h"
#include "e2e_cdiff/report/session_video.h"
#include "e2e_cdiff/scenario/closed_loop.h"
#include "progress.h"
#ifdef E2E_CDIFF_WITH_ROS
#include "e2e_cdiff/ros/session_bag.h"
#endif

namespace cdiff::cli {
namespace {

using Clock = std::chrono::steady_clock;

bool isJudged(int exit_code) { return exit_code == kPassed || exit_code == kVerdictFailed; }

/// The record of a session that never began.
void recordFailedStart(report::ResultWriter& writer, const std::string& text) {
  traffic::TrafficSnapshot snapshot;
  snapshot.status = traffic::SessionStatus::kError;
  snapshot.faults.push_back({0, "simulator", text});
  scenario::TickRecord record;
  record.snapshot = &snapshot;
  writer.observe(record);
}

double secondsSince(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// session.bag of a session that is to be recorded; without ROS there are no bags. One that cannot
/// be written is removed, and the session goes on.
class BagRecord : public scenario::SessionObserver {
 public:
  BagRecord(const scenario::SessionSetup& setup, const RunOutput& output,
            scenario::ClosedLoop& loop) {
    if (!output.record) return;
#ifdef E2E_CDIFF_WITH_ROS
    const ros::BagOrigin origin{"cdiff run", loop.world().simulatorVersion()};
    attempt([&] {
      bag_ = std::make_unique<ros::SessionBag>(setup, output.folder / "session.bag", origin);
    });
    loop.addObserver(*this);
#else
    (void)setup, (void)loop;
    throw core::InputError("--record needs a build with ROS (E2E_CDIFF_ROS=ON)");
#endif
  }
#ifdef E2E_CDIFF_WITH_ROS
  void observe(const scenario::TickRecord& record) override {
    if (bag_) attempt([&] { bag_->observe(record); });
  }
#else
  void observe(const scenario::TickRecord&) override {}
#endif
  /// Why the bag that was asked for is not there; empty when it is.
  const std::string& finish() {
#ifdef E2E_CDIFF_WITH_ROS
    if (bag_) attempt([&] { bag_->finish(); });
#endif
    return error_;
  }
  /// Removes what was recorded.
  void discard() {
#ifdef E2E_CDIFF_WITH_ROS
    if (bag_) bag_->discard();
    bag_.reset();
#endif
  }

 private:
#ifdef E2E_CDIFF_WITH_ROS
  void attempt(const std::function<void()>& writing) {
    try {
      writing();
    } catch (const std::exception& error) {
      std::cerr << "cdiff: " << error.what() << "; the other results are not affected\n";
      error_ = error.what();
      bag_.reset();
    }
  }
  std::unique_ptr<ros::SessionBag> bag_;
#endif
  std::string error_;
};

/// session.mp4 of a session that asks for it.
class VideoRecord {
 public:
  VideoRecord(const scenario::SessionSetup& setup, const std::filesystem::path& folder,
              scenario::ClosedLoop& loop) {
    if (!setup.options().video) return;
    video_ = std::make_unique<report::SessionVideo>(setup, folder);
    loop.addObserver(*video_);
    tell();
  }
  /// Removes what there is of it.
  void discard() { video_.reset(); }
  /// `exit_code` of the session, or that of an error at run time when its video is missing.
  int finish(const report::ResultWriter& writer, int exit_code) {
    if (!video_) return exit_code;
    video_->finish(writer.result());
    tell();
    return told_ && isJudged(exit_code) ? static_cast<int>(kRunTimeError) : exit_code;
  }

 private:
  void tell() {
    if (told_ || video_->error().empty()) return;
    std::cerr << "cdiff: " << video_->error() << "; the other results are not affected\n";
    told_ = true;
  }
  std::unique_ptr<report::SessionVideo> video_;
  bool told_ = false;
};

/// The session's table, and what it was asked to record.
void printTable(const report::ResultWriter& writer, const RunOutput& output) {
  if (output.quiet) return;
  std::cout << writer.table() << report::fileRow("bag", output.folder / "session.bag")
            << report::fileRow("video", output.folder / report::kVideoFile) << std::flush;
}

void finishResult(report::ResultWriter& writer, double wall_seconds) {
  try {
    writer.finish(wall_seconds);
  } catch (const core::InputError& error) {
    throw core::Error(error.what());  // no fault of the input: the folder could be written before
  }
  if (!writer.failure().empty()) std::cerr << "cdiff: " << writer.failure() << "\n";
}

/// Runs the session and records it; an exit code.
int drive(const scenario::SessionSetup& setup, const RunOutput& output, scenario::ClosedLoop& loop,
          const std::atomic<bool>& stop, Clock::time_point begin) {
  const scenario::ScenarioOptions& options = setup.options();
  report::ResultWriter writer(setup, {"cdiff run", loop.world().simulatorVersion(), true},
                              output.folder);
  Progress progress(scenario::longestTime(options.protocol, setup.egoRoute()));
  loop.addObserver(writer);
  if (!output.quiet) loop.addObserver(progress);
  BagRecord bag(setup, output, loop);
  VideoRecord video(setup, output.folder, loop);
  try {
    loop.run(stop);
  } catch (const std::exception&) {
    if (writer.failure().empty()) throw;
    bag.discard();
    video.discard();
  }
  const std::string& bag_error = bag.finish();
  if (!bag_error.empty()) writer.recordFault({0, "recorder", bag_error});
  finishResult(writer, secondsSince(begin));
  const int exit_code = video.finish(writer, writer.exitCode());
  printTable(writer, output);
  return !bag_error.empty() && isJudged(exit_code) ? static_cast<int>(kRunTimeError) : exit_code;
}

}  // namespace

int runSession(const scenario::ScenarioOptions& options, const RunOutput& output) {
  const std::atomic<bool>& stop = core::catchStopSignals();
  report::requireFreeFolder(output.folder, output.overwrite);
  const scenario::SessionSetup setup(options);
  const Clock::time_point begin = Clock::now();
  const auto claim = [&] {
    return report::ResultFolder(output.folder, "cdiff run", output.overwrite);
  };
  std::unique_ptr<scenario::ClosedLoop> loop;
  try {
    loop = std::make_unique<scenario::ClosedLoop>(setup);
  } catch (const core::SimulatorError& error) {
    const report::ResultFolder folder = claim();
    report::ResultWriter writer(setup, {"cdiff run", "unknown", true}, output.folder);
    recordFailedStart(writer, error.what());
    std::cerr << "cdiff: " << error.what() << "\n";
    writer.finish(secondsSince(begin));
    printTable(writer, output);
    return writer.exitCode();
  }
  const report::ResultFolder folder = claim();
  return drive(setup, output, *loop, stop, begin);
}

}  // namespace cdiff::cli
