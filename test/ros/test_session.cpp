// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// Whole sessions through roslaunch with a real SUMO, each with a master of its own on a free port.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <set>

#include "e2e_cdiff/TrafficSnapshot.h"
#include "e2e_cdiff/core/file.h"
#include "e2e_cdiff/core/text.h"
#include "e2e_cdiff/report/result_writer.h"
#include "e2e_cdiff/ros/replay.h"
#include "e2e_cdiff/ros/session_bag.h"
#include "e2e_cdiff/ros/tick_answers.h"
#include "e2e_cdiff/ros/topics.h"
#include "e2e_cdiff/scenario/closed_loop.h"
#include "e2e_cdiff/scenario/session_request.h"
#include "ros/recorded_bag.h"
#include "rosbag/bag.h"
#include "rosbag/view.h"
#include "sensor_msgs/Image.h"
#include "support/random_model.h"

namespace cdiff {
namespace {

namespace fs = std::filesystem;

nlohmann::json summaryIn(const fs::path& folder) {
  return nlohmann::json::parse(core::readFile(folder / "summary.json", "summary"));
}

class Session : public ::testing::Test {
 protected:
  Session()
      : folder_(fs::temp_directory_path() /
                ("e2e_cdiff_session_test_" + std::to_string(::getpid()))) {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~Session() override { fs::remove_all(folder_); }

  /// roslaunch of a launch file with arguments; answers its output. Results go to folder_ / "ros".
  /// `beside`: a command that runs while the session does, which is interrupted after it.
  std::string launch(const std::string& file, const std::string& arguments,
                     const std::string& beside = "") {
    const std::string find_port =
        "port=$(/usr/bin/python3 -c 'import socket; s = socket.socket(); s.bind((\"127.0.0.1\", "
        "0)); print(s.getsockname()[1])')";
    const std::string command =
        find_port + "; export PATH=/usr/bin:$PATH ROS_IP=127.0.0.1 ROS_HOME=" + folder_.string() +
        "/home ROS_MASTER_URI=http://127.0.0.1:$port; " + (beside.empty() ? "exec " : "") +
        "timeout -s INT 80 " E2E_CDIFF_DEVEL "/env.sh roslaunch -p $port " + file +
        " results:=" + results().string() + " " + arguments + " > " + log().string() + " 2>&1" +
        (beside.empty() ? ""
                        : " & launch=$!; " E2E_CDIFF_DEVEL "/env.sh " + beside +
                              "; kill -INT $launch; wait $launch; true");
    EXPECT_EQ(std::system(("bash -c '" + escaped(command) + "'").c_str()), 0);
    return core::readFile(log(), "log");
  }

  fs::path results() const { return folder_ / "ros"; }
  fs::path log() const { return folder_ / "log"; }
  nlohmann::json summary() const { return summaryIn(results()); }
  /// Source of the last fault; empty when there is none.
  std::string lastFaultSource() const {
    const nlohmann::json faults = summary()["faults"];
    return faults.empty() ? "" : faults.back()["source"].get<std::string>();
  }
  std::string exitCode() const { return core::readFile(results() / "exit_code", "exit code"); }

  fs::path folder_;

 private:
  static std::string escaped(const std::string& text) {
    std::string result;
    for (const char character : text)
      result += character == '\'' ? std::string("'\\''") : std::string(1, character);
    return result;
  }
};

/// The trace of the same session in one process.
std::string traceInOneProcess(const scenario::SessionRequest& request, const fs::path& folder) {
  test::runInOneProcess(request, folder);
  return core::sha256(core::readFile(folder / "trace.csv", "trace"));
}

/// What a summary says whatever the clock on the wall does.
nlohmann::json withoutWallClock(nlohmann::json summary) {
  summary.erase("wall_seconds");
  summary.erase("real_time_factor");
  for (auto& [planner, figures] : summary["planner_latency_ms"].items())
    figures = {{"n", figures["n"]}};
  return summary;
}

/// The data: URIs of the images that a report shows.
std::vector<std::string> picturesIn(const fs::path& folder) {
  const std::string report = core::readFile(folder / "report.html", "report");
  std::vector<std::string> pictures;
  const std::string begin = "data:image/png;base64,";
  for (std::size_t at = report.find(begin); at != std::string::npos;
       at = report.find(begin, at + 1))
    pictures.push_back(report.substr(at, report.find('"', at) - at));
  return pictures;
}

/// Number of messages by topic.
std::map<std::string, int> countsIn(const fs::path& bag_file) {
  std::map<std::string, int> counts;
  rosbag::Bag bag(bag_file.string(), rosbag::bagmode::Read);
  for (const rosbag::MessageInstance& message : rosbag::View(bag)) ++counts[message.getTopic()];
  return counts;
}

TEST_F(Session, HasTheTraceOfTheClosedLoopAndAReadableBag) {
  const std::string log = launch("e2e_cdiff session.launch",
                                 "scenario:=crossing_left_turn seed:=2 record:=true "
                                 "set:=\"protocol.time_limit=8 verdict.judge=false\"");
  ASSERT_TRUE(fs::exists(results() / "summary.json")) << log;
  EXPECT_EQ(summary()["status"], "timed_out") << log;
  EXPECT_EQ(exitCode(), "0\n");
  scenario::SessionRequest request;
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
  std::set<std::pair<std::string, ::ros::Time>> occupied;  ///< image topic and stamp
  std::set<std::pair<std::string, ::ros::Time>> shown;
  std::set<::ros::Time> guided;
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
        if (ros::contains(*snapshots.at(selection->tick), assignment.vehicle_id))
          images.occupied.emplace("/" + ros::imageTopic(assignment.slot), selection->header.stamp);
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
  scenario::SessionRequest request;
  request.scenario = "crossing_left_turn";
  request.seed = "2";
  request.set = {"protocol.time_limit=8", "verdict.judge=false"};
  EXPECT_EQ(summary()["trace_sha256"], traceInOneProcess(request, folder_ / "one_process"));
  BagImages images = imagesIn(results() / "session.bag");
  EXPECT_GT(images.occupied.size(), 0U) << "the session shows no CBV; choose one that does";
  for (int decision = 0; decision < 80; ++decision)  // 8 s at 10 Hz, the end decides nothing
    images.occupied.emplace("/ego/camera/image_raw", ::ros::Time(0.1 * decision));
  EXPECT_EQ(images.shown, images.occupied);
}

TEST_F(Session, DiffusionPlannerHasTheResultOfTheClosedLoopAndItsImagesInTheBag) {
  const fs::path alone = folder_ / "one_process";
  const std::string model = testing::writeRandomModel(folder_ / "model");
  const std::string settings = "protocol.time_limit=8 verdict.judge=false diffusion.model=" + model;
  const std::string log = launch("e2e_cdiff session.launch",
                                 "scenario:=crossing_left_turn seed:=2 record:=true "
                                 "cbv_planner:=diffusion set:=\"" +
                                     settings + "\"");
  EXPECT_EQ(exitCode(), "0\n") << log;
  scenario::SessionRequest request;
  request.scenario = "crossing_left_turn";
  request.seed = "2";
  request.cbv_planner = "diffusion";
  request.set = core::splitText(settings, ' ');
  test::runInOneProcess(request, alone);
  EXPECT_EQ(withoutWallClock(summary()), withoutWallClock(summaryIn(alone)));
  EXPECT_FALSE(summary()["cbv"]["plan"].is_null());
  EXPECT_FALSE(picturesIn(results()).empty());
  EXPECT_EQ(picturesIn(results()), picturesIn(alone));
  EXPECT_EQ(countsIn(results() / "session.bag"), countsIn(alone / "session.bag"));
  EXPECT_GT(summary()["planner_latency_ms"]["cbv:diffusion"]["n"], 0) << log;
  EXPECT_EQ(summary()["faults"].size(), 0U) << summary()["faults"];
  const BagImages images = imagesIn(results() / "session.bag");
  EXPECT_EQ(images.shown, images.occupied);
  std::set<::ros::Time> decisions;
  for (const auto& [topic, stamp] : images.occupied) decisions.insert(stamp);
  EXPECT_EQ(images.guided, decisions);
}

/// `metrics` of a summary as it is written.
std::string metricsTextIn(const fs::path& folder) {
  const std::string text = core::readFile(folder / "summary.json", "summary");
  const std::size_t begin = text.find("\n  \"metrics\":");
  return text.substr(begin, text.find("\n  \"planner_latency_ms\"", begin) - begin);
}

/// Expects the result of a replay to be the live one but for what the wall clock says.
void expectSameResult(const fs::path& replayed, const fs::path& live) {
  EXPECT_NE(metricsTextIn(live), "");
  EXPECT_EQ(metricsTextIn(replayed), metricsTextIn(live));
  nlohmann::json both[2] = {summaryIn(replayed), summaryIn(live)};
  for (nlohmann::json& summary : both) {
    summary.erase("wall_seconds");
    summary.erase("real_time_factor");
  }
  EXPECT_EQ(both[0], both[1]);
  EXPECT_EQ(core::sha256(core::readFile(replayed / "trace.csv", "trace")),
            core::sha256(core::readFile(live / "trace.csv", "trace")));
  EXPECT_EQ(picturesIn(replayed), picturesIn(live));
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
  const ros::ReplayResult offline = ros::replayBag(live / "session.bag", folder_ / "offline");
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
  scenario::SessionRequest request;
  request.scenario = "crossing_left_turn";
  request.seed = "2";
  request.cbv_planner = "pdm_lite";
  request.set = {"protocol.time_limit=20"};
  const fs::path live = folder_ / "live";
  test::runInOneProcess(request, live);
  fs::resize_file(live / "session.bag", fs::file_size(live / "session.bag") * 3 / 4);
  const ros::ReplayResult offline = ros::replayBag(live / "session.bag", folder_ / "offline");
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
  scenario::SessionRequest request;
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
  EXPECT_EQ(summary()["planner_latency_ms"]["ego:external"]["n"], 20)
      << log;  // 2 s at 10 Hz; the last tick decides nothing
  EXPECT_GT(summary()["ego"]["route_completion_percent"], 0.0);
}

TEST_F(Session, ToolsFindItsFramesAndNothingToComplainAbout) {
  const fs::path found = folder_ / "tools";
  fs::create_directories(found);
  const std::string log =
      launch(E2E_CDIFF_TEST_FOLDER "/looked_at.launch", "found:=" + found.string(),
             "bash " E2E_CDIFF_TEST_FOLDER "/look_at_session " + found.string());
  const std::string wtf = core::readFile(found / "roswtf", "roswtf's output");
  const std::size_t online = wtf.find("Online checks summary");
  ASSERT_NE(online, std::string::npos) << wtf << log;  // what comes before is the machine's
  EXPECT_NE(wtf.find("No errors or warnings", online), std::string::npos) << wtf;
  const std::string tf = core::readFile(found / "tf", "rostopic's output");
  EXPECT_NE(tf.find("child_frame_id: \"ego/base_link\""), std::string::npos) << tf;
  // map -> base_link as in the snapshot; the optical axis looks ahead, 6 degrees downwards.
  EXPECT_EQ(core::readFile(found / "frames", "frames"), "base_link 0 0 0\ncamera_optical 1\n");
}

/// Whether a fault of the session names both.
bool faultNames(const nlohmann::json& summary, const std::string& one, const std::string& other) {
  for (const nlohmann::json& fault : summary["faults"]) {
    const auto text = fault["text"].get<std::string>();
    if (text.find(one) != std::string::npos && text.find(other) != std::string::npos) return true;
  }
  return false;
}

// Nor does the pace: at most four times real time, tick 159 (7.95 s) comes after 1.99 s.
TEST_F(Session, NodeThatIsNoPartOfItChangesNothingAndIsNamed) {
  const std::string log = launch(E2E_CDIFF_TEST_FOLDER "/rogue.launch",
                                 "set:=\"protocol.time_limit=8 at_most=4 verdict.judge=false\"");
  ASSERT_TRUE(fs::exists(results() / "summary.json")) << log;
  scenario::SessionRequest request;
  request.scenario = "crossing_left_turn";
  request.seed = "2";
  request.cbv_planner = "pdm_lite";
  request.set = {"protocol.time_limit=8"};
  const fs::path alone = folder_ / "one_process";
  EXPECT_EQ(summary()["trace_sha256"], traceInOneProcess(request, alone)) << summary()["faults"];
  EXPECT_GT(summary()["cbv"]["count"], 0) << "the session shows no CBV; choose one that does";
  EXPECT_EQ(summary()["planner_latency_ms"]["cbv:pdm_lite"]["n"],
            summaryIn(alone)["planner_latency_ms"]["cbv:pdm_lite"]["n"]);
  EXPECT_GE(summary()["wall_seconds"], 1.9);
  const std::string session = core::readFile(results() / "session.yaml", "session");
  EXPECT_NE(session.find("deterministic: true"), std::string::npos);
  for (const char* topic :
       {"cbv/selection", "ego/control", "cbv_0/control", "cbv_0/rollout", "tick_ack", "traffic",
        "session", "metrics", "cbv_0/camera/image_raw"}) {
    EXPECT_TRUE(faultNames(summary(), std::string("on ") + topic + " from /rogue_node", "ignored"))
        << topic << summary()["faults"];
  }
  // The first of each topic, then the 10th, the 100th and the 1000th, and the sum: nine topics.
  EXPECT_LE(summary()["faults"].size(), 9U * 5U);
  EXPECT_EQ(ros::replayBag(results() / "session.bag", folder_ / "replay").exit_code, 0);
  EXPECT_EQ(summaryIn(folder_ / "replay")["planner_latency_ms"], summary()["planner_latency_ms"]);
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

}  // namespace
}  // namespace cdiff
