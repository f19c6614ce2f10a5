// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// The training of PPO goes all the way on two small networks: collected, trained, judged,
// interrupted, resumed, exported.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "core/file.h"
#include "e2e_cdiff/core/exceptions.h"
#include "learning/stopping_buffer.h"
#include "learning/task.h"
#include "learning/task_registry.h"
#include "learning/trainer.h"
#include "learning/training_folder.h"
#include "planners/ppo/ppo_network.h"
#include "planners/ppo/training/training_routes.h"
#include "suite/suite_route.h"
#include "support/temporary_folder.h"

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

class PpoTrainingTest : public ::testing::Test {
 protected:
  PpoTrainingTest() { writeSuite(folder_.path() / "suite"); }

  /// Three iterations of two steps.
  learning::Training start(const std::string& output, const std::vector<std::string>& set = {}) {
    learning::TaskRegistry tasks;
    tasks.add(ppoTraining());
    learning::Training training = tasks.training("ppo");
    training.options.output = (folder_.path() / output).string();
    training.options.device = "cpu";
    training.options.report_every = 0.0;
    std::vector<std::string> all = {"suite=" + (folder_.path() / "suite").string(),
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
  std::string errorOf(const learning::Training& training) {
    try {
      learning::train(training, stop_, log_);
    } catch (const core::InputError& error) {
      return error.what();
    }
    return "trained";
  }
  learning::Checkpoint checkpoint(const std::string& output) const {
    return learning::readCheckpoint(folder_.path() / output / "policy.checkpoint");
  }
  void expectSameWeights(const std::string& left, const std::string& right) const {
    const learning::Checkpoint expected = checkpoint(left);
    const learning::Checkpoint found = checkpoint(right);
    ASSERT_EQ(found.tensors.size(), 4U * 13U);  // weight, two moments and average of 13 tensors
    for (const auto& [name, tensor] : expected.tensors)
      EXPECT_TRUE(at::equal(found.tensors.at(name), tensor)) << name;
  }

  test::TemporaryFolder folder_;
  std::atomic<bool> stop_{false};
  std::ostringstream log_;
};

TEST_F(PpoTrainingTest, TrainsJudgesAndExports) {
  learning::train(start("model"), stop_, log_);
  const PpoActor actor(PpoActor::readWeights(folder_.path() / "model"));
  EXPECT_NE(actor.deviation()[0], 1.0F);  // moved from its start
  const auto record =
      nlohmann::json::parse(core::readFile(folder_.path() / "model" / "training.json", "record"));
  EXPECT_EQ(record.at("stages").at("policy").at("steps"), 6);
  EXPECT_EQ(record.at("data").at("networks"), 2);
  EXPECT_EQ(record.at("data").at("held_out_networks"), 1);
  EXPECT_GE(record.at("held_out").at("goal_share").get<double>(), 0.0);
  const std::string curves =
      core::readFile(folder_.path() / "model" / "curves.csv", "training curves");
  for (const char* row : {"policy,1,", "policy,3,", "policy,5,", "episode_return",
                          "episode_goal_share", "held_out_return"})
    EXPECT_NE(curves.find(row), std::string::npos) << row;
  const std::string card = core::readFile(folder_.path() / "model" / "model_card.md", "card");
  EXPECT_NE(card.find("1 routes on 1 networks of the suite 'tiny'"), std::string::npos) << card;
}

// Stopped after its second iteration, whose checkpoint is on disk; resumed with another number of
// threads.
TEST_F(PpoTrainingTest, AResumedTrainingEqualsAnUninterruptedOneToTheBit) {
  learning::train(start("whole"), stop_, log_);
  test::StoppingBuffer buffer(stop_, "policy step 4/6");
  std::ostream log(&buffer);
  EXPECT_THROW(learning::train(start("resumed"), stop_, log), core::Interrupted);
  EXPECT_EQ(checkpoint("resumed").facts.at("steps"), 4);
  stop_ = false;
  learning::train(start("resumed", {"resume=true", "workers=2"}), stop_, log_);
  expectSameWeights("whole", "resumed");
}

// A stop within an iteration lets it finish.
TEST_F(PpoTrainingTest, AStopWaitsForTheEndOfTheIteration) {
  test::StoppingBuffer buffer(stop_, "policy step 3/6");
  std::ostream log(&buffer);
  EXPECT_THROW(learning::train(start("model"), stop_, log), core::Interrupted);
  EXPECT_EQ(checkpoint("model").facts.at("steps"), 4);
}

// A kill in the second iteration leaves the checkpoint of the first, and rows of the curves beyond
// it, the last of them cut off.
TEST_F(PpoTrainingTest, AKillLosesTheIterationAtWorkOnly) {
  learning::train(start("whole"), stop_, log_);
  test::StoppingBuffer buffer(stop_, "policy step 2/6");
  std::ostream log(&buffer);
  EXPECT_THROW(learning::train(start("killed"), stop_, log), core::Interrupted);
  EXPECT_EQ(checkpoint("killed").facts.at("steps"), 2);
  const fs::path curves = folder_.path() / "killed" / "curves.csv";
  core::writeFileAtomically(curves, core::readFile(curves, "curves") +
                                        "policy,3,9.0,episode_return,77.0\npolicy,3,9.0,epi");
  stop_ = false;
  learning::train(start("killed", {"resume=true"}), stop_, log_);
  expectSameWeights("whole", "killed");
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
      errorOf(start("m", {"suite="})).find("suite, the route suite to learn on, is not given"),
      std::string::npos);
  EXPECT_NE(errorOf(start("m", {"data=somewhere"})).find("makes its samples itself"),
            std::string::npos);
  EXPECT_NE(errorOf(start("m", {"simulator=sumo", "workers=2"})).find("needs workers 1"),
            std::string::npos);
  for (const char* suite : {"development", "sealed_a", "sealed_b"}) {
    EXPECT_NE(errorOf(start("m", {std::string("suite=") + suite})).find("is for evaluation"),
              std::string::npos)
        << suite;
  }
}

TEST_F(PpoTrainingTest, RefusesToResumeWithOtherSettings) {
  learning::train(start("model"), stop_, log_);
  for (const char* change : {"environments=3", "discount=0.9", "buffer=96"}) {
    EXPECT_NE(errorOf(start("model", {"resume=true", change})).find("--resume cannot go on"),
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
