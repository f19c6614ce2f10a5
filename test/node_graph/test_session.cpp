// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// Whole sessions through roslaunch with a real SUMO, each with a master of its own on a free port.
#include <gtest/gtest.h>

#include <atomic>
#include <nlohmann/json.hpp>
#include <set>

#include "core/file.h"
#include "core/output_folder.h"
#include "core/text.h"
#include "e2e_cdiff/GuidanceReport.h"
#include "e2e_cdiff/TrafficSnapshot.h"
#include "node_graph/bags/replay.h"
#include "node_graph/bags/session_bag_writer.h"
#include "node_graph/lockstep/tick_answers.h"
#include "node_graph/messages/topics.h"
#include "node_graph/session_launch.h"
#include "page/result_writer.h"
#include "rosbag/bag.h"
#include "rosbag/view.h"
#include "sensor_msgs/Image.h"
#include "session/closed_loop.h"
#include "session/session_request.h"
#include "support/random_model.h"

namespace cdiff {
namespace {

TEST_F(Session, HasTheTraceOfTheClosedLoopAndAReadableBag) {
  const std::string log = launch("e2e_cdiff session.launch",
                                 "scenario:=crossing_left_turn seed:=2 record:=true "
                                 "set:=\"protocol.time_limit=8 verdict.judge=false\"");
  ASSERT_TRUE(fs::exists(results() / "summary.json")) << log;
  EXPECT_EQ(summary()["status"], "timed_out") << log;
  EXPECT_EQ(exitCode(), "0\n");
  session::SessionRequest request;
  request.scenario = "crossing_left_turn";
  request.seed = "2";
  request.set = {"protocol.time_limit=8", "verdict.judge=false"};
  const fs::path alone = folder_ / "one_process";
  EXPECT_EQ(summary()["trace_sha256"], traceInOneProcess(request, alone));
  EXPECT_EQ(withoutWallClock(summary()), withoutWallClock(summaryIn(alone)));
  EXPECT_EQ(countsIn(results() / "session.bag"), countsIn(alone / "session.bag"));
  EXPECT_GT(summary()["cbv"]["count"], 0) << "the session shows no CBV; choose one that does";

  rosbag::Bag bag((results() / "session.bag").string(), rosbag::bagmode::Read);
  std::uint64_t ticks = 0;
  for (const rosbag::MessageInstance& message : rosbag::View(bag, rosbag::TopicQuery("/traffic"))) {
    EXPECT_EQ(message.instantiate<::e2e_cdiff::TrafficSnapshot>()->tick, ticks++);
  }
  EXPECT_EQ(ticks, 161U);  // 8 s of 0.05 s, and tick 0
}

/// What a bag shows of each decision: slots that a selection occupies with a vehicle of the
/// snapshot, and images by topic.
struct BagImages {
  std::set<std::pair<std::string, ros::Time>> occupied;  ///< image topic and stamp
  std::set<std::pair<std::string, ros::Time>> shown;
  std::set<ros::Time> guided;
};

BagImages imagesIn(const fs::path& file) {
  BagImages images;
  rosbag::Bag bag(file.string(), rosbag::bagmode::Read);
  std::map<std::uint64_t, ::e2e_cdiff::TrafficSnapshot::ConstPtr> snapshots;
  for (const rosbag::MessageInstance& message : rosbag::View(bag, rosbag::TopicQuery("/traffic"))) {
    const auto snapshot = message.instantiate<::e2e_cdiff::TrafficSnapshot>();
    snapshots[snapshot->tick] = snapshot;
  }
  for (const rosbag::MessageInstance& message : rosbag::View(bag)) {
    if (const auto selection = message.instantiate<::e2e_cdiff::CbvSelection>()) {
      for (const auto& assignment : selection->assignments) {
        if (node_graph::contains(*snapshots.at(selection->tick), assignment.vehicle_id))
          images.occupied.emplace("/" + node_graph::imageOf(assignment.slot).name(),
                                  selection->header.stamp);
      }
    }
    if (const auto image = message.instantiate<sensor_msgs::Image>()) {
      EXPECT_EQ(image->width, 160U);
      EXPECT_EQ(image->height, 96U);
      EXPECT_EQ(image->encoding, "rgb8");
      images.shown.emplace(message.getTopic(), image->header.stamp);
    }
    if (const auto guidance = message.instantiate<::e2e_cdiff::GuidanceReport>())
      images.guided.insert(guidance->header.stamp);
  }
  return images;
}

TEST_F(Session, CamerasShowOccupiedSlotsAtDecisionsAndChangeNothing) {
  const std::string log = launch("e2e_cdiff session.launch",
                                 "scenario:=crossing_left_turn seed:=2 record:=true camera:=true "
                                 "set:=\"protocol.time_limit=8 verdict.judge=false\"");
  EXPECT_EQ(exitCode(), "0\n") << log;
  session::SessionRequest request;
  request.scenario = "crossing_left_turn";
  request.seed = "2";
  request.set = {"protocol.time_limit=8", "verdict.judge=false"};
  EXPECT_EQ(summary()["trace_sha256"], traceInOneProcess(request, folder_ / "one_process"));
  BagImages images = imagesIn(results() / "session.bag");
  EXPECT_GT(images.occupied.size(), 0U) << "the session shows no CBV; choose one that does";
  for (int decision = 0; decision < 80; ++decision)  // 8 s at 10 Hz, the end decides nothing
    images.occupied.emplace("/ego/camera/image_raw", ros::Time(0.1 * decision));
  EXPECT_EQ(images.shown, images.occupied);
}

/// crossing_left_turn with CBVs of the diffusion planner for 8 s.
class DiffusionSession : public Session {
 protected:
  /// The session as nodes, with a bag, and in one process; expects equal results and no fault.
  void runBoth(const std::string& mode, const std::string& more_settings = "") {
    const std::string settings = "protocol.time_limit=8 verdict.judge=false" + more_settings;
    const std::string log =
        launch("e2e_cdiff session.launch",
               "scenario:=crossing_left_turn seed:=2 record:=true mode:=" + mode +
                   " cbv_planner:=diffusion set:=\"" + settings + "\"");
    EXPECT_EQ(exitCode(), "0\n") << log;
    session::SessionRequest request;
    request.scenario = "crossing_left_turn";
    request.seed = "2";
    request.mode = mode;
    request.cbv_planner = "diffusion";
    request.set = core::splitText(settings, ' ');
    test::runInOneProcess(request, alone());
    EXPECT_EQ(withoutWallClock(summary()), withoutWallClock(summaryIn(alone())));
    EXPECT_EQ(summary()["faults"].size(), 0U) << summary()["faults"];
  }
  fs::path alone() const { return folder_ / "one_process"; }
};

TEST_F(DiffusionSession, HasTheResultOfTheClosedLoopAndItsImagesInTheBag) {
  runBoth("naturalistic", " diffusion.model=" + testing::writeRandomModel(folder_ / "model"));
  EXPECT_FALSE(summary()["cbv"]["plan"].is_null());
  EXPECT_FALSE(picturesIn(results()).empty());
  EXPECT_EQ(picturesIn(results()), picturesIn(alone()));
  EXPECT_EQ(countsIn(results() / "session.bag"), countsIn(alone() / "session.bag"));
  EXPECT_GT(summary()["planner_latency_ms"]["cbv:diffusion"]["n"], 0);
  const BagImages images = imagesIn(results() / "session.bag");
  EXPECT_EQ(images.shown, images.occupied);
  std::set<ros::Time> decisions;
  for (const auto& [topic, stamp] : images.occupied) decisions.insert(stamp);
  EXPECT_EQ(images.guided, decisions);
}

TEST_F(DiffusionSession, ChallengingHasTheResultOfTheClosedLoop) {
  runBoth("challenging");
  EXPECT_GT(summary()["challenge"]["decisions"], 0);
}

TEST_F(Session, PlannersBySlotHaveTheResultOfTheClosedLoop) {
  const fs::path alone = folder_ / "one_process";
  const std::string settings = "protocol.time_limit=10 verdict.judge=false diffusion.model=" +
                               testing::writeRandomModel(folder_ / "model");
  const std::string log = launch("e2e_cdiff session.launch",
                                 "scenario:=roundabout_cross seed:=1 "
                                 "cbv_planner:=diffusion+pdm_lite set:=\"" +
                                     settings + "\"");
  EXPECT_EQ(exitCode(), "0\n") << log;
  session::SessionRequest request;
  request.scenario = "roundabout_cross";
  request.seed = "1";
  request.cbv_planner = "diffusion+pdm_lite";
  request.set = core::splitText(settings, ' ');
  test::runInOneProcess(request, alone);
  EXPECT_EQ(withoutWallClock(summary()), withoutWallClock(summaryIn(alone)));
  EXPECT_EQ(summary()["cbv_planner"], "diffusion+pdm_lite");
  EXPECT_EQ(summary()["faults"].size(), 0U) << summary()["faults"];
  std::set<std::string> planners;
  const nlohmann::json result = summary();
  for (const auto& selection : result["cbv"]["selections"])
    planners.insert(selection["planner"].get<std::string>());
  EXPECT_EQ(planners, (std::set<std::string>{"diffusion", "pdm_lite"}))
      << "the session shows one CBV alone; choose one that shows two";
}

TEST_F(Session, ReplayOfTheNodeGraphsBagHasItsResultOnTheCommandLineAndFromRoslaunch) {
  const std::string model = testing::writeRandomModel(folder_ / "model");
  const std::string log =
      launch("e2e_cdiff session.launch",
             "scenario:=crossing_left_turn seed:=2 record:=true "
             "cbv_planner:=diffusion set:=\"protocol.time_limit=8 verdict.judge=false "
             "diffusion.model=" +
                 model + "\"");
  ASSERT_EQ(exitCode(), "0\n") << log;
  const fs::path live = folder_ / "live";
  fs::rename(results(), live);
  fs::remove_all(folder_ / "model");  // the bag alone must do
  const node_graph::ReplayResult offline =
      node_graph::replayBag(live / "session.bag", folder_ / "offline");
  EXPECT_EQ(offline.exit_code, 0);
  EXPECT_EQ(core::joinText(offline.findings, "; "), "");
  expectSameResult(folder_ / "offline", live);
  const std::string replay_log =
      launch("e2e_cdiff replay.launch", "rate:=0 bag:=" + (live / "session.bag").string());
  ASSERT_EQ(exitCode(), "0\n") << replay_log;
  expectSameResult(results(), live);
  const std::string session = core::readFile(results() / "session.yaml", "session");
  EXPECT_NE(session.find("deployment: \"replay.launch\"\nrecorded_by: \"roslaunch of e2e_cdiff "),
            std::string::npos)
      << session;
  EXPECT_TRUE(fs::exists(live / "session.bag"));
}

TEST_F(Session, ReplayLaunchOfACutOffBagHasTheResultOfTheCommandLine) {
  session::SessionRequest request;
  request.scenario = "crossing_left_turn";
  request.seed = "2";
  request.cbv_planner = "pdm_lite";
  request.set = {"protocol.time_limit=20"};
  const fs::path live = folder_ / "live";
  test::runInOneProcess(request, live);
  fs::resize_file(live / "session.bag", fs::file_size(live / "session.bag") * 3 / 4);
  const node_graph::ReplayResult offline =
      node_graph::replayBag(live / "session.bag", folder_ / "offline");
  EXPECT_EQ(offline.exit_code, 2);
  EXPECT_FALSE(offline.findings.empty());
  const std::string log =
      launch("e2e_cdiff replay.launch", "rate:=0 bag:=" + (live / "session.bag").string());
  EXPECT_EQ(exitCode(), "2\n") << log;
  EXPECT_NE(log.find("the recording ends at tick"), std::string::npos) << log;
  expectSameResult(results(), folder_ / "offline");
}

TEST_F(Session, WholeRoundaboutHasTheTraceOfTheClosedLoop) {
  const std::string log = launch("e2e_cdiff session.launch", "scenario:=roundabout_cross seed:=1");
  ASSERT_TRUE(fs::exists(results() / "summary.json")) << log;
  session::SessionRequest request;
  request.scenario = "roundabout_cross";
  request.seed = "1";
  EXPECT_EQ(summary()["trace_sha256"], traceInOneProcess(request, folder_ / "one_process"));
  EXPECT_GE(summary()["cbv"]["count"], 2) << "the session shows fewer than two CBVs";
}

TEST_F(Session, ExternalEgoDrivesInLockstep) {
  std::string file =
      core::readFile(fs::path(E2E_CDIFF_TEST_FOLDER) / "external_ego.launch", "launch file");
  ASSERT_FALSE(file.empty());
  const std::string log = launch(E2E_CDIFF_TEST_FOLDER "/external_ego.launch", "");
  EXPECT_EQ(summary()["status"], "timed_out") << log;
  EXPECT_EQ(summary()["ego_planner"], "external");
  EXPECT_EQ(summary()["late_answers"]["planners"]["ego:external"]["asked"], 20)
      << log;  // 2 s at 10 Hz; the last tick decides nothing
  EXPECT_EQ(summary()["late_answers"]["count"], 0);
  EXPECT_EQ(summary()["planner_latency_ms"]["ego:external"]["n"], 20)
      << "the simulator's own times";
  EXPECT_GT(summary()["ego"]["route_completion_percent"], 0.0);
}

TEST_F(Session, MissingNodeIsNamedAndAResultIsLeft) {
  const std::string log = launch(E2E_CDIFF_TEST_FOLDER "/missing_planner.launch", "");
  EXPECT_EQ(exitCode(), "2\n") << log;
  EXPECT_EQ(summary()["status"], "error");
  EXPECT_EQ(lastFaultSource(), "cbv_planner_node") << summary()["faults"] << log;
}

TEST_F(Session, NodeThatDiesEndsTheSession) {
  const std::string log = launch(E2E_CDIFF_TEST_FOLDER "/dying_metrics.launch", "");
  EXPECT_EQ(exitCode(), "2\n") << log;
  EXPECT_EQ(summary()["status"], "error");
  ASSERT_FALSE(summary()["faults"].empty()) << log;
  EXPECT_EQ(lastFaultSource(), "metrics_node") << summary()["faults"];
}

TEST_F(Session, BadInputGivesItsExitCodeAndASentence) {
  const std::string log = launch("e2e_cdiff session.launch", "scenario:=crossing_left_trun");
  EXPECT_EQ(exitCode(), "3\n") << log;
  EXPECT_NE(log.find("crossing_left_turn"), std::string::npos) << log;
}

TEST_F(Session, AFolderWithAResultIsNotTouched) {
  fs::create_directories(results());
  core::writeOwnFile(results() / "summary.json", "of an earlier session");
  core::writeOwnFile(results() / "exit_code", "0\n");
  ::setenv("E2E_CDIFF_EXIT_CODE_FILE", (folder_ / "code").c_str(), 1);
  const std::string log = launch("e2e_cdiff session.launch", "scenario:=crossing_left_turn");
  ::unsetenv("E2E_CDIFF_EXIT_CODE_FILE");
  EXPECT_NE(log.find("holds an earlier result (summary.json)"), std::string::npos) << log;
  EXPECT_EQ(core::readFile(folder_ / "code", "exit code"), "3\n");
  EXPECT_EQ(exitCode(), "0\n");
  EXPECT_EQ(core::readFile(results() / "summary.json", "summary"), "of an earlier session");
  EXPECT_EQ(std::distance(fs::directory_iterator(results()), fs::directory_iterator()), 3)
      << "and the record";
}

TEST_F(Session, ADemandThatSumoRefusesIsBadInput) {
  const fs::path demand = folder_ / "bad.rou.xml";
  core::writeFileAtomically(
      demand, "<routes><trip id=\"t\" depart=\"900\" from=\"nowhere\" to=\"sb_b1\"/></routes>");
  fs::create_directories(results());
  core::writeOwnFile(results() / "exit_code", "0\n");
  core::writeOwnFile(results() / "session.mp4", "of an earlier session");
  const std::string log =
      launch("e2e_cdiff session.launch",
             "scenario:=crossing_straight overwrite:=true set:=demand=" + demand.string());
  EXPECT_NE(log.find("SUMO refuses the demand '" + demand.string() + "': "), std::string::npos)
      << log;
  EXPECT_EQ(exitCode(), "3\n");
  EXPECT_FALSE(fs::exists(results() / "session.mp4"));
  EXPECT_FALSE(fs::exists(results() / ".lock"));
}

}  // namespace
}  // namespace cdiff
