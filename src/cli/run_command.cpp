// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The commands `cdiff run` and `cdiff demo`: one session without nodes, and its result folder.
#include <atomic>
#include <chrono>
#include <filesystem>
#include <functional>
#include <future>
#include <iostream>
#include <limits>
#include <memory>
#include <optional>

#include "cli/commands.h"
#include "cli/progress.h"
#include "core/clock.h"
#include "core/forked_work.h"
#include "core/markup.h"
#include "core/program.h"
#include "core/stage_times.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "page/result_writer.h"
#include "planners/registry.h"
#include "plugins/plugin_loader.h"
#include "record/result_folder.h"
#include "record/session_text.h"
#include "record/session_yaml.h"
#include "session/closed_loop.h"
#include "session/scenario_review.h"
#include "session/session_request.h"
#include "session/steering_file.h"
#include "suite/seal.h"
#include "video/session_video.h"
#include "watch/live_session.h"
#ifdef E2E_CDIFF_WITH_ROS
#include "cli/watched_run.h"
#include "node_graph/bags/recorded_steering.h"
#include "node_graph/bags/session_bag_writer.h"
#include "node_graph/result_reserve.h"
#endif

namespace cdiff::cli {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

// One session in this process: closed loop, result folder, progress, and what a signal or a lost
// simulator does to them.

/// Where the results go, and how much is printed.
struct RunOutput {
  fs::path folder;
  bool quiet = false;      ///< no progress line, no table
  bool record = false;     ///< also write session.bag; InputError where built without ROS
  bool overwrite = false;  ///< what an earlier session left in the folder is removed
  std::optional<std::uint16_t> watch_port = {};  ///< of a live page; 0: a free one; absent: none
  double answer_timeout = 30.0;  ///< of one call of a plug-in or of libsumo, wall time [s]
};

/// What is said may quote plug-ins, SUMO, ffmpeg and files.
void say(const std::string& text) { std::cerr << "cdiff: " << core::plainText(text) << "\n"; }

bool isJudged(int exit_code) {
  return exit_code == ExitCode::kPassed || exit_code == ExitCode::kVerdictFailed;
}

/// The record of a session that never began.
void recordFailedStart(page::ResultWriter& writer, const std::string& text) {
  traffic::TrafficSnapshot snapshot;
  snapshot.status = traffic::SessionStatus::kError;
  snapshot.faults.push_back({0, "simulator", text});
  session::TickRecord record;
  record.snapshot = &snapshot;
  writer.observe(record);
}

double secondsSince(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// session.bag of a session that is to be recorded; without ROS there are no bags. One that cannot
/// be written is removed, and the session goes on.
class BagRecording : public session::SessionObserver {
 public:
  BagRecording(const session::SessionSetup& setup, const RunOutput& output,
               session::ClosedLoop& loop) {
    if (!output.record) return;
#ifdef E2E_CDIFF_WITH_ROS
    const node_graph::BagOrigin origin{"cdiff run", loop.world().simulatorVersion()};
    attempt([&] {
      bag_ = std::make_unique<node_graph::SessionBagWriter>(setup, output.folder / "session.bag",
                                                            origin);
    });
    loop.addObserver(*this);
#else
    (void)setup, (void)loop;
    throw core::InputError("--record needs a build with ROS (E2E_CDIFF_ROS=ON)");
#endif
  }
#ifdef E2E_CDIFF_WITH_ROS
  void observe(const session::TickRecord& record) override {
    if (bag_) attempt([&] { bag_->observe(record); });
  }
#else
  void observe(const session::TickRecord&) override {}
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
      say(error.what() + std::string("; the other results are not affected"));
      error_ = error.what();
      bag_.reset();
    }
  }
  std::unique_ptr<node_graph::SessionBagWriter> bag_;
#endif
  std::string error_;
};

/// session.mp4 of a session that asks for it.
class VideoRecord {
 public:
  VideoRecord(const session::SessionSetup& setup, const fs::path& folder,
              session::ClosedLoop& loop) {
    if (!setup.options().video) return;
    video_ = std::make_unique<video::SessionVideo>(setup, folder);
    loop.addObserver(*video_);
    reportError();
  }
  /// Removes the part of it that was written.
  void discard() { video_.reset(); }
  /// `exit_code` of the session, or that of an error at run time when its video is missing.
  int finish(const page::ResultWriter& writer, int exit_code) {
    if (!video_) return exit_code;
    video_->finish(writer.result());
    reportError();
    return reported_ && isJudged(exit_code) ? ExitCode::kRunTimeError : exit_code;
  }

 private:
  void reportError() {
    if (reported_ || video_->error().empty()) return;
    say(video_->error() + "; the other results are not affected");
    reported_ = true;
  }
  std::unique_ptr<video::SessionVideo> video_;
  bool reported_ = false;
};

/// The live page of a session that is to be watched; its address is printed. nullptr where none is.
std::unique_ptr<watch::LiveSession> makeLiveSession(const session::SessionSetup& setup,
                                                    const RunOutput& output,
                                                    session::ClosedLoop& loop) {
  if (!output.watch_port) return nullptr;
  auto live = std::make_unique<watch::LiveSession>(
      setup, std::make_unique<watch::ControlLink>(loop.control()), *output.watch_port);
  std::cerr << "cdiff: " << live->invitation() << std::flush;
  return live;
}

/// Whether code of others that may end the session runs in its process: plug-ins, or SUMO.
bool keepsTicks(const session::SessionSetup& setup) {
  return !plugins::loadPlugins().empty() || setup.options().simulation.link == "libsumo";
}

/// What such a session keeps for the process that waits for this one; else nothing.
std::unique_ptr<session::SessionObserver> makeReserve(const session::SessionSetup& setup,
                                                      const RunOutput& output,
                                                      session::ClosedLoop& loop) {
#ifdef E2E_CDIFF_WITH_ROS
  if (!keepsTicks(setup)) return nullptr;
  const node_graph::BagOrigin origin{"cdiff run", loop.world().simulatorVersion()};
  auto reserve = std::make_unique<node_graph::ProcessReserve>(setup, output.folder, origin);
  loop.addObserver(*reserve);
  return reserve;
#else
  (void)setup, (void)output, (void)loop;
  return nullptr;
#endif
}

/// The session's table, and what it was asked to record.
void printTable(const page::ResultWriter& writer, const RunOutput& output) {
  if (output.quiet) return;
  const fs::path folder = writer.folder();
  std::cout << writer.table() << record::fileRow("bag", folder / "session.bag")
            << record::fileRow("video", folder / video::kVideoFile) << std::flush;
  std::error_code gone;
  if (!fs::equivalent(folder, output.folder, gone))
    say("the result folder '" + output.folder.string() +
        "' was renamed while the session ran; the result is in '" + folder.string() + "'");
}

void finishResult(page::ResultWriter& writer, double wall_seconds) {
  try {
    writer.finish(wall_seconds);
  } catch (const core::InputError& error) {
    throw core::Error(error.what());  // no fault of the input: the folder could be written before
  }
  if (!writer.failure().empty()) say(writer.failure());
}

/// Runs the session and records it; an exit code.
int drive(const session::SessionSetup& setup, const RunOutput& output, session::ClosedLoop& loop,
          watch::LiveSession* live, const std::atomic<bool>& stop, Clock::time_point begin) {
  const session::ScenarioOptions& options = setup.options();
  const auto reserve = makeReserve(setup, output, loop);
  // Plug-ins may use what observers and planners share.
  if (plugins::loadPlugins().empty()) loop.observeBeside();
  page::ResultWriter writer(setup, {"cdiff run", loop.world().simulatorVersion(), true},
                            output.folder);
  Progress progress(session::longestTime(options.protocol, setup.egoRoute()),
                    options.protocol.time_limit_speed_percent > 0.0);
  loop.addObserver(writer);
  if (live != nullptr) {
    loop.addObserver(*live);
    live->begin(writer);
  }
  if (!output.quiet) loop.addObserver(progress);
  BagRecording bag(setup, output, loop);
  VideoRecord video(setup, output.folder, loop);
  const auto times = core::wantedStageTimes();
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
  core::reachStage(core::WorkStage::kResultWritten);
  core::writeStageTimes(times.get());
  const int exit_code = video.finish(writer, writer.exitCode());
  printTable(writer, output);
  if (live != nullptr) live->finish();
  const record::Verdict& verdict = writer.result().verdict;
  if (verdict.outcome == record::Outcome::kNotJudged && options.verdict.judge)
    say("NOT JUDGED: " + verdict.reasons.front() + "; exit code 0 means nothing");
  const std::string untested = record::untestedText(writer.result());
  if (!untested.empty()) say(untested + "; why, says report.html, 'Why others were no CBVs'");
  return !bag_error.empty() && isJudged(exit_code) ? ExitCode::kRunTimeError : exit_code;
}

/// A session that only has to be driven.
struct PreparedRun {
  PreparedRun(const session::ScenarioOptions& options, RunOutput to)
      : output(std::move(to)), setup(options) {}
  RunOutput output;
  session::SessionSetup setup;
  std::optional<session::LoopParts> parts = {};  ///< absent: not made yet
};

/// Makes the drivable area of the level that the ego starts on, which the first tick needs.
void makeStartLevel(const session::SessionSetup& setup) {
  const Eigen::Vector3d start = setup.egoRoute().path().pointAt(0.0);
  setup.drivableArea().contains(start.head<2>(), start.z());
}

/// Claims the folder and runs the session.
int runHere(PreparedRun& run, const std::atomic<bool>& stop) {
  const RunOutput& output = run.output;
  const session::SessionSetup& setup = run.setup;
  if (!run.parts) run.parts = session::makeParts(setup);
  const Clock::time_point begin = Clock::now();
  const auto level = std::async(std::launch::async, makeStartLevel, std::cref(setup));
  const auto claim = [&] {
    auto folder =
        std::make_unique<record::ResultFolder>(output.folder, "cdiff run", output.overwrite);
    core::reachStage(core::WorkStage::kFolderTaken);
    return folder;
  };
  std::unique_ptr<session::ClosedLoop> loop;
  try {
    loop = std::make_unique<session::ClosedLoop>(setup, std::move(*run.parts));
  } catch (const core::SimulatorError& error) {
    const auto folder = claim();
    page::ResultWriter writer(setup, {"cdiff run", "unknown", true}, output.folder);
    recordFailedStart(writer, error.what());
    say(error.what());
    writer.finish(secondsSince(begin));
    printTable(writer, output);
    return writer.exitCode();
  }
  const std::unique_ptr<watch::LiveSession> live = makeLiveSession(setup, output, *loop);
  const auto folder = claim();
  return drive(setup, output, *loop, live.get(), stop, begin);
}

/// Runs to the end and answers the exit code. A stop ends the session as interrupted. Throws
/// InputError for a scenario that SUMO refuses, and for a folder that is in use or holds an earlier
/// result (nothing in it is touched then); a simulator that cannot start or is lost gives a result
/// folder with status error. With ROS the session runs in a process of its own, which may crash;
/// only calls of what others have written must answer in time.
int runSession(PreparedRun& run, const std::atomic<bool>& stop) {
  for (const std::string& warning : session::scenarioWarnings(run.setup))
    say("warning: " + warning);
#ifdef E2E_CDIFF_WITH_ROS
  const RunOutput& output = run.output;
  const double answer_timeout =
      keepsTicks(run.setup) ? output.answer_timeout : std::numeric_limits<double>::infinity();
  return runWatched(
      {run.setup, output.folder, output.overwrite, output.quiet, answer_timeout, stop},
      [&] { return runHere(run, stop); });
#else
  return runHere(run, stop);
#endif
}

struct RunArguments {
  session::SessionRequest request;
  std::string steering;
  std::string results;
  bool quiet = false;
  bool record = false;
  bool overwrite = false;
  bool watch = false;
  std::uint16_t watch_port = 0;
  double answer_timeout = 30.0;
};

/// Of the live page, where one is asked for.
std::optional<std::uint16_t> portOf(const RunArguments& arguments) {
  if (!arguments.watch) return std::nullopt;
  return arguments.watch_port;
}

std::vector<session::SteeringEntry> steeringOf(const std::string& source) {
#ifdef E2E_CDIFF_WITH_ROS
  return node_graph::readSteering(source);
#else
  return session::readSteering(source);
#endif
}

void requireSameSession(const std::string& source, const session::ScenarioOptions& options) {
#ifdef E2E_CDIFF_WITH_ROS
  const session::SteeredSession recorded = node_graph::steeredSession(source);
#else
  const session::SteeredSession recorded = session::steeredSession(source);
#endif
  session::requireSameSession(source, recorded, options, record::packageVersion());
}

/// Throws InputError for a scenario that cannot be set up, and for a folder as runSession does.
std::shared_ptr<PreparedRun> preparedRun(const session::ScenarioOptions& options,
                                         const RunOutput& output) {
  record::requireFreeFolder(output.folder, output.overwrite);
  return std::make_shared<PreparedRun>(options, output);
}

/// Throws InputError as `preparedRun`.
std::shared_ptr<PreparedRun> prepare(const RunArguments& arguments) {
  suite::requireOpen(arguments.request.scenario);
  session::SessionRequest request = arguments.request;
  if (!arguments.steering.empty()) request.steering = steeringOf(arguments.steering);
  const session::ScenarioOptions options = session::resolveRequest(request);
  if (!arguments.steering.empty()) requireSameSession(arguments.steering, options);
  const fs::path folder =
      arguments.results.empty()
          ? fs::path("results") / (core::fileName(options.name) + "_seed" +
                                   std::to_string(options.seed) + "_" + core::timeForFileName())
          : fs::path(arguments.results);
  return preparedRun(options, {folder, arguments.quiet, arguments.record, arguments.overwrite,
                               portOf(arguments), arguments.answer_timeout});
}

/// SIGINT, SIGTERM and SIGHUP end the session as interrupted.
int run(const RunArguments& arguments) {
  const std::atomic<bool>& stop = core::catchStopSignals();
  return runSession(*prepare(arguments), stop);
}

/// One shipped session; its table names the report. It passes when the session ran, whatever the
/// verdict.
int demo(const fs::path& folder) {
  session::SessionRequest request;
  request.scenario = "roundabout_cross";
  request.seed = "1";
  RunOutput output;
  output.folder = fs::absolute(folder);
  output.overwrite = true;
  const std::atomic<bool>& stop = core::catchStopSignals();
  const int exit_code = runSession(*preparedRun(session::resolveRequest(request), output), stop);
  return isJudged(exit_code) ? ExitCode::kPassed : exit_code;
}

/// Adds the command, whose options fill `arguments`.
CLI::App* addRunOptions(CLI::App& program, RunArguments& arguments) {
  CLI::App* command = program.add_subcommand("run", "Run one session and write its result folder");
  session::SessionRequest& request = arguments.request;
  command->add_option("scenario", request.scenario,
                      "Shipped scenario, scenario file, or OpenSCENARIO file (*.xosc)");
  command->add_option("--bench2drive", request.bench2drive,
                      "Bench2Drive route file, instead of a scenario");
  command->add_option("--route", request.route, "Id of a route in that file");
  command->add_option("--network", request.network,
                      "Network: shipped name, *.net.xml, *.xodr or *.osm");
  command->add_option("--mode", request.mode, "naturalistic, challenging or safety_critical");
  command->add_option("--ego-planner", request.ego_planner, "Planner of the ego");
  command->add_option("--cbv-planner", request.cbv_planner,
                      "Planner of the CBVs; these can attack: " +
                          core::joinText(planners::guidedPlannerNames(), ", "));
  command->add_option("--seed", request.seed, "Root seed instead of the scenario's");
  command->add_option("--set", request.set, "Any key of the scenario as key=value; may be repeated")
      ->allow_extra_args(false);
  command->add_option("--steering", arguments.steering,
                      "Steer as a result folder, its summary.json or session.bag, or a scenario "
                      "file says");
  command->add_option("--results", arguments.results,
                      "Result folder (default: results/SCENARIO_SEED_TIME)");
  command->add_flag("--overwrite", arguments.overwrite,
                    "Replace what an earlier session left in the result folder");
  command->add_flag("--record", arguments.record, "Also write session.bag, for replay and rviz");
  command->add_flag("--video", request.video, "Also write session.mp4: front view beside top view");
  command->add_flag("--ignore-unsupported", request.ignore_unsupported,
                    "Go on without elements of an OpenSCENARIO file that are not supported");
  CLI::Option* watch = command->add_flag("--watch", arguments.watch,
                                         "Show and steer the session on a page of this computer");
  command
      ->add_option("--watch-port", arguments.watch_port,
                   "Port of that page (default: any that is free)")
      ->needs(watch);
  command
      ->add_option("--answer-timeout", arguments.answer_timeout,
                   "Seconds of wall time for one call of a plug-in or of libsumo (default: 30)")
      ->check(CLI::PositiveNumber);
  command->add_flag("--quiet", arguments.quiet, "No progress line, no table");
  return command;
}

}  // namespace

core::ForkedRun prepareRun(const std::vector<std::string>& words) {
  RunArguments arguments;
  CLI::App program;
  addRunOptions(program, arguments);
  std::vector<std::string> reversed(words.rbegin(), words.rend());  // as CLI11 takes them
  program.parse(reversed);
  const std::shared_ptr<PreparedRun> run = prepare(arguments);
  makeStartLevel(run->setup);  // here: children cannot hand on what they make
  // A plug-in's planner may remember in its library what it did before: its child makes it anew.
  if (plugins::loadPlugins().empty()) run->parts = session::makeParts(run->setup);
  return [run] { return runSession(*run, core::catchStopSignals()); };
}

void addDemoCommand(CLI::App& program, int& exit_code) {
  auto results = std::make_shared<std::string>("results/demo");
  CLI::App* command =
      program.add_subcommand("demo", "Run one shipped session and print where its report is");
  command
      ->add_option("--results", *results, "Result folder; what an earlier session left is replaced")
      ->capture_default_str();
  command->callback([results, &exit_code] { exit_code = demo(*results); });
}

void addRunCommand(CLI::App& program, int& exit_code) {
  auto arguments = std::make_shared<RunArguments>();
  addRunOptions(program, *arguments)->callback([arguments, &exit_code] {
    exit_code = run(*arguments);
  });
}

}  // namespace cdiff::cli
