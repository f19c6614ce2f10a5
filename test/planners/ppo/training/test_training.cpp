// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// The training of PPO goes all the way on two small networks: collected, trained, judged,
// interrupted, resumed, exported.
#include "learning/task.h"
#include "learning/training_fixture.h"
#include "planners/ppo/ppo_network.h"
#include "planners/ppo/training/training_routes.h"
#include "suite/suite_route.h"

namespace cdiff::planners {

learning::TaskDescriptor ppoTraining();

namespace {

namespace fs = std::filesystem;

suite::SuiteRoute route(const std::string& name, const std::string& network,
                        const std::vector<std::string>& edges, double start) {
  suite::SuiteRoute route;
  route.name = name;
  route.network = network;
  route.edges = edges;
  route.start_offset = start;
  route.end_offset = 20.0;
  route.manoeuvre = "straight";
  route.length = 100.0;
  route.density = "high";
  return route;
}

/// A suite of two shipped networks with a route on each.
void writeSuite(const fs::path& folder) {
  suite::Suite suite;
  suite.name = "tiny";
  suite.folder = folder;
  suite.routes = {route("over", "crossing_district", {"a2_b2", "b2_c2"}, 20.0),
                  route("around", "roundabout",
                        {"south_in", "ring_south_east", "ring_east_north", "north_out"}, 95.0)};
  fs::create_directories(folder / "scenarios");
  for (const suite::SuiteRoute& one : suite.routes) {
    fs::create_directories(suite.networkFile(one).parent_path());
    const fs::path shipped =
        core::shareFolder() / "networks" / one.network / (one.network + ".net.xml");
    fs::copy_file(shipped, suite.networkFile(one));
    core::writeFileAtomically(suite.scenarioFile(one), suite::scenarioText(one));
  }
  core::writeFileAtomically(folder / "suite.yaml", suite::manifestText(suite));
}

class PpoTrainingTest : public test::TrainingFixture {
 protected:
  PpoTrainingTest() { writeSuite(path("suite")); }

  /// Three iterations of two steps.
  learning::Training start(const std::string& output, const std::vector<std::string>& set = {}) {
    learning::Training training = trainingOf(ppoTraining(), output);
    std::vector<std::string> all = {"suite=" + path("suite").string(),
                                    "steps=6",
                                    "batch=32",
                                    "buffer=64",
                                    "passes=1",
                                    "environments=2",
                                    "workers=1",
                                    "validation_share=0.5"};
    all.insert(all.end(), set.begin(), set.end());
    for (const std::string& assignment : all) core::overrideOption(assignment, "test", training);
    return training;
  }
};

TEST_F(PpoTrainingTest, TrainsJudgesAndExports) {
  train(start("model"));
  const PpoActor actor(PpoActor::readWeights(path("model")));
  EXPECT_NE(actor.deviation()[0], 1.0F);  // moved from its start
  const nlohmann::json written = record("model");
  EXPECT_EQ(written.at("stages").at("policy").at("steps"), 6);
  EXPECT_EQ(written.at("data").at("networks"), 2);
  EXPECT_EQ(written.at("data").at("held_out_networks"), 1);
  EXPECT_GE(written.at("held_out").at("goal_share").get<double>(), 0.0);
  const std::string curves = text("model", "curves.csv");
  for (const char* row : {"policy,1,", "policy,3,", "policy,5,", "episode_return",
                          "episode_goal_share", "held_out_return"})
    EXPECT_NE(curves.find(row), std::string::npos) << row;
  const std::string card = text("model", "model_card.md");
  EXPECT_NE(card.find("1 routes on 1 networks of the suite 'tiny'"), std::string::npos) << card;
}

// Stopped after its second iteration, whose checkpoint is on disk; resumed with another number of
// threads.
TEST_F(PpoTrainingTest, AResumedTrainingEqualsAnUninterruptedOneToTheBit) {
  train(start("whole"));
  trainUntil(start("resumed"), "policy step 4/6");
  EXPECT_EQ(checkpoint("resumed", "policy").facts.at("steps"), 4);
  train(start("resumed", {"resume=true", "workers=2"}));
  EXPECT_EQ(checkpoint("whole", "policy").tensors.size(), 4U * 13U)
      << "weight, two moments and average of 13 tensors";
  expectSameCheckpoints("whole", "resumed", "policy");
}

// A stop within an iteration lets it finish.
TEST_F(PpoTrainingTest, AStopWaitsForTheEndOfTheIteration) {
  trainUntil(start("model"), "policy step 3/6");
  EXPECT_EQ(checkpoint("model", "policy").facts.at("steps"), 4);
}

// A kill in the second iteration leaves the checkpoint of the first, and rows of the curves beyond
// it, the last of them cut off.
TEST_F(PpoTrainingTest, AKillLosesTheIterationAtWorkOnly) {
  train(start("whole"));
  trainUntil(start("killed"), "policy step 2/6");
  EXPECT_EQ(checkpoint("killed", "policy").facts.at("steps"), 2);
  const fs::path curves = path("killed") / "curves.csv";
  core::writeFileAtomically(curves, core::readFile(curves, "curves") +
                                        "policy,3,9.0,episode_return,77.0\npolicy,3,9.0,epi");
  train(start("killed", {"resume=true"}));
  expectSameCheckpoints("whole", "killed", "policy");
  const std::string rows = core::readFile(curves, "curves");
  EXPECT_EQ(rows.find("77.0"), std::string::npos);
  std::size_t returns = 0;
  for (std::size_t at = rows.find(",episode_return,"); at != std::string::npos;
       at = rows.find(",episode_return,", at + 1))
    ++returns;
  EXPECT_EQ(returns, 3U) << rows;
}

TEST_F(PpoTrainingTest, RefusesWhatCannotBeTrained) {
  EXPECT_NE(
      trainingText(start("m", {"suite="})).find("suite, the route suite to learn on, is not given"),
      std::string::npos);
  EXPECT_NE(trainingText(start("m", {"data=somewhere"})).find("makes its samples itself"),
            std::string::npos);
  EXPECT_NE(trainingText(start("m", {"simulator=sumo", "workers=2"})).find("needs workers 1"),
            std::string::npos);
  for (const char* suite : {"development", "sealed_a", "sealed_b"}) {
    EXPECT_NE(trainingText(start("m", {std::string("suite=") + suite})).find("is for evaluation"),
              std::string::npos)
        << suite;
  }
}

TEST_F(PpoTrainingTest, RefusesToResumeWithOtherSettings) {
  train(start("model"));
  for (const char* change : {"environments=3", "discount=0.9", "buffer=96"}) {
    EXPECT_NE(trainingText(start("model", {"resume=true", change})).find("--resume cannot go on"),
              std::string::npos)
        << change;
  }
}

TEST(PpoRoutes, HoldsOutWholeNetworks) {
  const test::TemporaryFolder folder;
  writeSuite(folder.path());
  const PpoRoutes routes(folder.path().string(), 0.1, 3);
  EXPECT_EQ(routes.networks(), 2U);
  EXPECT_EQ(routes.heldOutNetworks(), 1U);
  ASSERT_EQ(routes.training().size(), 1U);
  ASSERT_EQ(routes.heldOut().size(), 1U);
  EXPECT_NE(routes.training()[0], routes.heldOut()[0]);
  const PpoRoutes all(folder.path().string(), 0.0, 3);
  EXPECT_EQ(all.heldOutNetworks(), 0U);
  EXPECT_EQ(all.training(), (std::vector<std::size_t>{0, 1}));
  EXPECT_EQ(all.heldOut(), all.training());
}

}  // namespace
}  // namespace cdiff::planners
