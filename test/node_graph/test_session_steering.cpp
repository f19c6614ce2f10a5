// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// Sessions that are steered while they run: by hand through the services of the node graph, by
// their scenario, and by the record of another session.
#include <gtest/gtest.h>

#include <fstream>

#include "e2e_cdiff/GuidanceReport.h"
#include "e2e_cdiff/TrafficSnapshot.h"
#include "e2e_cdiff/core/exceptions.h"
#include "node_graph/bags/recorded_steering.h"
#include "node_graph/bags/replay.h"
#include "node_graph/session_launch.h"
#include "rosbag/bag.h"
#include "rosbag/view.h"
#include "what_if/recorded_run.h"
#include "what_if/take_over.h"

namespace cdiff {
namespace {

const std::string kScenario =
    "scenario:=crossing_left_turn seed:=3 cbv_planner:=diffusion record:=true ";

/// "TICK WHAT AFTER" of every change in a bag.
std::vector<std::string> changesIn(const fs::path& file) {
  std::vector<std::string> changes;
  rosbag::Bag bag(file.string(), rosbag::bagmode::Read);
  for (const rosbag::MessageInstance& message : rosbag::View(bag, rosbag::TopicQuery("/traffic"))) {
    const auto snapshot = message.instantiate<::e2e_cdiff::TrafficSnapshot>();
    for (const ::e2e_cdiff::SteeringChange& change : snapshot->steering)
      changes.push_back(std::to_string(snapshot->tick) + " " + change.what + " " + change.after);
  }
  return changes;
}

/// Weights of the objectives of the first CBV by their names, by tick.
std::map<std::uint64_t, std::map<std::string, double>> weightsIn(const fs::path& file) {
  std::map<std::uint64_t, std::map<std::string, double>> weights;
  rosbag::Bag bag(file.string(), rosbag::bagmode::Read);
  for (const rosbag::MessageInstance& message :
       rosbag::View(bag, rosbag::TopicQuery("/cbv/guidance"))) {
    const auto report = message.instantiate<::e2e_cdiff::GuidanceReport>();
    if (report->vehicles.empty()) continue;
    for (const ::e2e_cdiff::ObjectiveReport& objective : report->vehicles.front().objectives)
      weights[report->tick][objective.name] = objective.weight;
  }
  return weights;
}

std::vector<std::string> changesIn(const nlohmann::json& summary) {
  std::vector<std::string> changes;
  for (const nlohmann::json& change : summary["steering"]["changes"]) {
    changes.push_back(std::to_string(change["tick"].get<int>()) + " " +
                      change["what"].get<std::string>() + " " + change["after"].get<std::string>());
  }
  return changes;
}

session::SessionRequest requestOf(const std::vector<std::string>& set) {
  session::SessionRequest request;
  request.scenario = "crossing_left_turn";
  request.seed = "3";
  request.cbv_planner = "diffusion";
  request.set = set;
  return request;
}

TEST_F(Session, SteeredByHandIsNotJudgedAndRepeatsToTheSameBytes) {
  const fs::path found = folder_ / "found";
  const std::string log =
      launch("e2e_cdiff session.launch", kScenario + "set:=\"protocol.time_limit=8 at_most=1\"",
             CDIFF_STEERING_HAND " " + found.string() + " " + results().string());
  ASSERT_TRUE(fs::exists(results() / "summary.json")) << log;
  // 1 is OK, 0 unsupported, 2 not found, 3 not in this state, 4 refused, 101 there already.
  EXPECT_EQ(core::readFile(found, "answers"),
            "pause 1\npause by another client 101\npause again 101\nno step 3\n"
            "too many steps 3\nstep 1\nsteps 1\nticks of 5 steps 5\nodometry of the CBV 1\n"
            "profile 1\nweight 1\nweight by another client 1\nweight by dynparam 0\n"
            "too large by dynparam 0\nslider 0\nweight out of range 4\n"
            "weight that is no number 4\nunknown vehicle 4\n"
            "target speed 1\nremove 1\nremove nobody 2\nspawn on the ego 101\nreset 0\n"
            "steps with what was steered 1\nresume 1\nstep while running 3\npace 1\n");
  const nlohmann::json recorded = summary();
  EXPECT_EQ(recorded["verdict"]["outcome"], "not_judged") << recorded["verdict"];
  EXPECT_EQ(recorded["steering"]["by_hand"], true);
  const nlohmann::json changes = recorded["steering"]["changes"];
  ASSERT_EQ(changes.size(), 6U) << changes;
  EXPECT_EQ(changes[0]["what"], "profile");
  EXPECT_EQ(changes[0]["before"], "naturalistic");
  EXPECT_EQ(changes[0]["by"], "node /steering_hand");
  EXPECT_EQ(changes[1]["before"], "50") << "the new profile's";
  EXPECT_EQ(changes[2]["what"], "weight.traffic_avoidance");
  EXPECT_EQ(changes[3]["after"], "1") << "the last place of the slider";
  EXPECT_EQ(changesIn(results() / "session.bag"), changesIn(recorded));
  EXPECT_TRUE(recorded["guidance"].contains("collision_seeking")) << recorded["guidance"];
  auto weights = weightsIn(results() / "session.bag");
  const std::uint64_t steered = changes[0]["tick"];
  ASSERT_TRUE(weights.count(steered) == 1 && weights.count(steered - 2) == 1) << steered;
  EXPECT_EQ(weights[steered - 2].count("collision_seeking"), 0U);
  EXPECT_EQ(weights[steered]["collision_seeking"], 20.0) << "in the decision of the change";
  EXPECT_EQ(weights[steered]["traffic_avoidance"], 3.0);
  EXPECT_EQ(weights[steered]["speed"], 1.0);
  const fs::path replayed = folder_ / "replayed";
  node_graph::replayBag(results() / "session.bag", replayed);
  EXPECT_EQ(summaryIn(replayed)["steering"], recorded["steering"]);
  EXPECT_EQ(summaryIn(replayed)["verdict"], recorded["verdict"]);
  const what_if::RecordedRun run(results());
  EXPECT_EQ(run.scenario().steering.size(), 6U);
  const session::SessionSetup setup(run.scenario());
  const what_if::TakeOver take_over{steered + 20, steered + 30, ""};  // with what was steered
  const auto course =
      what_if::driveClosed(run, what_if::Driver(setup, what_if::DriverChoice()), setup, take_over);
  EXPECT_NE(course.trace.find("\n" + std::to_string(steered + 30) + ",ego,"), std::string::npos);

  session::SessionRequest request = requestOf({"protocol.time_limit=8"});
  const fs::path bag = folder_ / "recorded.bag";
  fs::copy_file(results() / "session.bag", bag);
  request.steering = node_graph::readSteering(bag);
  const fs::path alone = folder_ / "one_process";
  EXPECT_EQ(traceInOneProcess(request, alone), recorded["trace_sha256"]);
  EXPECT_EQ(changesIn(summaryIn(alone)), changesIn(recorded));
  EXPECT_NE(summaryIn(alone)["verdict"]["outcome"], "not_judged");
  launch("e2e_cdiff session.launch", kScenario + "overwrite:=true steering:=" + bag.string() +
                                         " set:=\"protocol.time_limit=8\"");
  EXPECT_EQ(summary()["trace_sha256"], recorded["trace_sha256"]);
  EXPECT_EQ(summary()["steering"]["by_hand"], false);
}

TEST_F(Session, AReplayRefusesWhoSteers) {
  const fs::path recorded = folder_ / "recorded";
  test::recordSession(recorded, {"protocol.time_limit=8"});
  const fs::path script = folder_ / "ask.sh";
  std::ofstream(script) << "for try in $(seq 200); do rosservice info /steer >/dev/null 2>&1 && "
                           "break; sleep 0.1; done\n"
                        << "cd " << folder_.string() << "\n"
                        << "rosservice call /steer '{what: target_speed, value: \"9\"}' >steer\n"
                        << "rosservice call /set_simulation_state 'state: {state: 2}' >pause\n"
                        << "rosservice call /delete_entity 'entity: ego' >delete\n"
                        << "for try in $(seq 300); do [ -e " << results().string()
                        << "/exit_code ] && break; sleep 0.1; done\n";
  const std::string log =
      launch("e2e_cdiff replay.launch", "rate:=1 bag:=" + (recorded / "session.bag").string(),
             "bash " + script.string());
  for (const char* answer : {"steer", "pause", "delete"}) {
    const std::string text = core::readFile(folder_ / answer, "answer");
    EXPECT_NE(text.find("result: 0"), std::string::npos) << text << log;
    EXPECT_NE(text.find("this is the replay of a bag"), std::string::npos) << text;
  }
  EXPECT_EQ(core::readFile(results() / "trace.csv", "trace"),
            core::readFile(recorded / "trace.csv", "trace"));
}

// Who repeats steering means the session that recorded it.
TEST_F(Session, SteeringOfAnotherSessionOrVersionIsRefused) {
  test::recordSession(folder_ / "recorded", {"protocol.time_limit=1"});
  const fs::path bag = folder_ / "recorded" / "session.bag";
  const session::SteeredSession of_bag = node_graph::steeredSession(bag);
  const session::SteeredSession of_folder = node_graph::steeredSession(bag.parent_path());
  EXPECT_EQ(of_bag.scenario, of_folder.scenario);
  EXPECT_EQ(of_bag.seed, of_folder.seed);
  EXPECT_EQ(of_bag.version, of_folder.version);
  session::ScenarioOptions options;
  options.name = of_bag.scenario;
  options.seed = of_bag.seed;
  const auto refusal = [&](const std::string& version) -> std::string {
    try {
      session::requireSameSession(bag, of_bag, options, version);
    } catch (const core::InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(refusal(of_bag.version), "");
  EXPECT_NE(refusal("0.0.1").find("e2e_cdiff " + of_bag.version + " recorded its steering"),
            std::string::npos)
      << refusal("0.0.1");
  ++options.seed;
  EXPECT_NE(refusal(of_bag.version).find("and this session is"), std::string::npos);
  const std::string log =
      launch("e2e_cdiff session.launch", kScenario + "seed:=77 steering:=" + bag.string());
  EXPECT_EQ(exitCode(), "3\n") << log;
  EXPECT_NE(log.find("with seed 77"), std::string::npos) << log;
}

// The CBVs attack from 4 s on; a paced session drops decisions, but not what they carry.
TEST_F(Session, SteeringOfAPacedSessionIsFollowedButCannotBeRepeated) {
  const fs::path list = folder_ / "turn.yaml";
  std::ofstream(list) << "steering: [{at: 4, profile: safety_critical}]\n";
  const std::string log = launch(
      "e2e_cdiff session.launch",
      kScenario + "set:=\"protocol.time_limit=8 real_time_factor=4\" steering:=" + list.string());
  ASSERT_TRUE(fs::exists(results() / "summary.json")) << log;
  EXPECT_EQ(changesIn(summary()), std::vector<std::string>{"80 profile safety_critical"});
  for (const fs::path& record : {results(), results() / "session.bag"}) {
    try {
      node_graph::readSteering(record);
      FAIL() << "no error of " << record;
    } catch (const core::InputError& error) {
      EXPECT_NE(std::string(error.what()).find("real_time_factor"), std::string::npos);
    }
  }
}

}  // namespace
}  // namespace cdiff
