// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// A road of 600 m along x with a limit of 10 m/s; the ego drives its last 495 m (start 100 m, goal
// 5 m before the end) at 8 m/s: 61.9 s.
#include <gtest/gtest.h>

#include <fstream>

#include "session/scenario_review.h"
#include "session/session_request.h"
#include "support/error_text.h"
#include "support/network_text.h"
#include "support/temporary_folder.h"

namespace cdiff::session {
namespace {

class ScenarioReview : public testing::Test {
 protected:
  ScenarioReview() {
    const std::string file = (folder_.path() / "road.net.xml").string();
    std::ofstream(file) << test::NetworkText().edge("road", {"0,0 600,0"}).text();
    options_ = defaultScenario();
    options_.network = file;
    options_.demand = "none";
    options_.route.edges = {"road"};
    options_.route.start_offset = 100.0;
    options_.verdict = VerdictOptions::standard();
  }
  std::vector<std::string> warnings() const { return scenarioWarnings(SessionSetup(options_)); }

  test::TemporaryFolder folder_;
  ScenarioOptions options_;
};

TEST_F(ScenarioReview, FindsNothingWhereRulesAndTimeFit) {
  EXPECT_EQ(warnings(), std::vector<std::string>{});
}

TEST_F(ScenarioReview, WarnsOfAScenarioThatCannotFail) {
  EXPECT_TRUE(hasRules(options_.verdict));
  options_.verdict = {};
  EXPECT_FALSE(hasRules(options_.verdict));
  ASSERT_EQ(warnings().size(), 1U);
  EXPECT_NE(warnings()[0].find("NO VERDICT RULES"), std::string::npos) << warnings()[0];
  options_.verdict.judge = false;  // asked for
  EXPECT_EQ(warnings().size(), 0U);
  options_.verdict.judge = true;
  options_.verdict.maximum_red_lights = 0.0;  // any rule will do
  EXPECT_EQ(warnings().size(), 0U);
}

TEST_F(ScenarioReview, WarnsOfARouteThatTheTimeLimitCutsOff) {
  const SessionSetup setup(options_);
  EXPECT_NEAR(drivingTime(options_, setup.egoRoute()), 495.0 / 8.0, 0.2);
  options_.protocol = loadProtocol("rift_dev10");
  ASSERT_EQ(warnings().size(), 1U);
  // 40 s x 8 m/s = 320 m of 495 m.
  for (const char* part : {"495 m take 62 s", "ends after 40 s, at 65 %", "protocol.time_limit"})
    EXPECT_NE(warnings()[0].find(part), std::string::npos) << warnings()[0];
  options_.protocol.time_limit = 70.0;
  EXPECT_EQ(warnings().size(), 0U);
  options_.protocol.time_limit = 40.0;
  options_.target_speed = 20.0;  // the lane's limit holds: 49.5 s
  EXPECT_NE(warnings().at(0).find("take 50 s"), std::string::npos) << warnings()[0];
}

// One lane of 600 m holds 80 vehicles of 7.5 m.
TEST_F(ScenarioReview, WarnsOfADemandThatTheNetworkCannotHold) {
  const std::string file = (folder_.path() / "cars.rou.xml").string();
  options_.demand = file;
  const auto warningsFor = [&](int number) {
    std::ofstream(file) << "<routes><route id=\"r\" edges=\"road\"/><flow id=\"f\" route=\"r\" "
                           "begin=\"0\" end=\"10\" number=\""
                        << number << "\"/></routes>";
    return warnings();
  };
  EXPECT_EQ(warningsFor(900).size(), 0U);
  const std::vector<std::string> found = warningsFor(100000);
  ASSERT_EQ(found.size(), 1U);
  for (const std::string& part : {"'" + file + "' has 100000 vehicles depart",
                                  std::string("hold 80"), std::string("give at most 16")})
    EXPECT_NE(found[0].find(part), std::string::npos) << found[0];
}

TEST(TrialWarnings, NameWhatSuitsNoSession) {
  ScenarioOptions options;
  options.demand = "cars.rou.xml";
  TrafficTrial trial;
  trial.simulated = 70.0;
  trial.wall = 1.0;
  trial.most = 12;
  trial.asked = 30.0;
  EXPECT_EQ(trialWarnings(options, trial).size(), 0U);
  trial.asked = 100000.0;
  ASSERT_EQ(trialWarnings(options, trial).size(), 1U);
  EXPECT_NE(trialWarnings(options, trial)[0].find("has 100000 vehicles depart"), std::string::npos);
  trial.wall = 71.0;
  EXPECT_EQ(trialWarnings(options, trial).size(), 2U);
  trial.asked = 0.0;
  trial.most = 0;
  ASSERT_EQ(trialWarnings(options, trial).size(), 1U);
  EXPECT_NE(trialWarnings(options, trial)[0].find("begin_time"), std::string::npos);
  options.demand = "none";
  EXPECT_EQ(trialWarnings(options, trial).size(), 0U);
}

// The shipped roundabout: the demand's flow asks for 100,000 vehicles within 100 s. Warm-up and
// time limit are 1 s each.
TEST_F(ScenarioReview, TriesTheDemandOnSumo) {
  const std::string file = (folder_.path() / "cars.rou.xml").string();
  options_.network = "roundabout";
  const map::ImportedNetwork network = map::importNetwork("roundabout");
  const map::RoadNetwork roads = map::RoadNetwork::fromText(network.text, "roundabout");
  options_.route.edges = {roads.edgeIds().front()};
  options_.route.start_offset = 5.0;
  options_.demand = file;
  options_.traffic.warm_up = 1.0;
  options_.protocol.time_limit = 1.0;
  options_.protocol.time_limit_speed_percent = 0.0;
  const auto tried = [&](const std::string& edges) {
    std::ofstream(file) << "<routes><route id=\"r\" edges=\"" << edges
                        << "\"/><flow id=\"f\" route=\"r\" begin=\"0\" end=\"100\" "
                           "number=\"100000\"/></routes>";
    return tryTraffic(SessionSetup(options_), 60.0);
  };
  const TrafficTrial trial = tried(roads.edgeIds().front());
  EXPECT_NEAR(trial.simulated, 2.0, 0.1);
  EXPECT_NEAR(trial.asked, 2000.0, 60.0);  // 2 s of 100
  EXPECT_GE(trial.most, 1U);
  EXPECT_NE(test::errorOf([&] { tried("no_such_edge"); }).find("SUMO refuses the demand '" + file),
            std::string::npos);
}

}  // namespace
}  // namespace cdiff::session
