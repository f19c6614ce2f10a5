// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "cli/cdiff_command.h"
#include "planners/trainings.h"

namespace cdiff::cli {
namespace {

namespace fs = std::filesystem;

/// What `cdiff collect`, `train` and `report --training` say of what they cannot use.
class DataCommands : public test::CdiffCommand {};

TEST_F(DataCommands, ABagNeedsItsTopicsNamed) {
  std::ofstream(path("a.bag")) << "no bag";
  EXPECT_EQ(cdiff({"collect", "--bags", path("a.bag"), "--results", path("data")}), 3);
  expectOutput("--topics");
  expectOutput("odometry");
  std::ofstream(path("topics.yaml")) << "image: /camera\nodometri: /odom\n";
  const std::vector<std::string> words = {
      "collect",           "--bags",    path("a.bag"), "--topics",
      path("topics.yaml"), "--results", path("data")};
  EXPECT_EQ(cdiff(words), 3);
  expectOutput("topics.yaml");
  expectOutput("odometry");
  std::ofstream(path("topics.yaml")) << "image: /camera\nodometry: /odom\n";
  EXPECT_EQ(cdiff(words), 3);
  expectOutput("is no ROS bag");
  EXPECT_FALSE(fs::exists(path("data/shards/a.shard")));
}

TEST_F(DataCommands, TwoBagsOfOneNameAreRefused) {
  std::ofstream(path("topics.yaml")) << "image: /camera\nodometry: /odom\n";
  EXPECT_EQ(cdiff({"collect", "--bags", path("a.bag") + "," + path("b/a.bag"), "--topics",
                   path("topics.yaml"), "--results", path("data")}),
            3);
  expectOutput("two bags are called 'a'");
}

TEST_F(DataCommands, WhatWouldBeIgnoredBesideBagsIsRefused) {
  std::ofstream(path("topics.yaml")) << "image: /camera\nodometry: /odom\n";
  const std::vector<std::string> bags = {
      "collect",           "--bags",    path("a.bag"), "--topics",
      path("topics.yaml"), "--results", path("data")};
  const std::vector<std::vector<std::string>> others = {{"--scenarios", "roundabout_cross"},
                                                        {"--seeds", "2"},
                                                        {"--jobs", "2"},
                                                        {"--duration", "20"},
                                                        {"--keep-bags"},
                                                        {"--no-images"},
                                                        {"--scenes"},
                                                        {"--set", "collection.period=1"}};
  for (const std::vector<std::string>& other : others) {
    std::vector<std::string> words = bags;
    words.insert(words.end(), other.begin(), other.end());
    EXPECT_EQ(cdiff(words), 3);
    expectOutput("excludes");
    expectOutput(other.front());
  }
  EXPECT_EQ(cdiff({"collect", "--topics", path("topics.yaml"), "--results", path("data")}), 3);
  expectOutput("--topics requires --bags");
}

TEST_F(DataCommands, TheTrainersExitCodeAndMessageComeThrough) {
  fs::create_directories(path("data"));
  EXPECT_EQ(cdiff({"train", "--data", path("data"), "--output", path("model")}), 3);
  expectOutput(path("data"));
  std::ofstream(path("data/broken.shard")) << "no shard";
  EXPECT_EQ(cdiff({"train", "--data", path("data"), "--output", path("model")}), 3);
  expectOutput("broken.shard");
  EXPECT_FALSE(fs::exists(path("model")));
}

TEST_F(DataCommands, HelpOfTheTrainerHasALineAndTheDefaultOfEachOption) {
  EXPECT_EQ(cdiff({"train", "--help"}), 0);
  expectOutput("Usage: cdiff train [OPTIONS]");
  expectOutput("--steps INT=20000");
  expectOutput("--learning-rate FLOAT=0.0002");
  expectOutput("--stage TEXT=all");
  expectOutput("Do not mirror every second sample");
  EXPECT_EQ(output().find("{false}"), std::string::npos) << output();
  std::istringstream lines(output());
  std::size_t options = 0;
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("  --", 0) != 0) continue;
    ++options;
    // The help starts in column 40 of the same line, behind a blank.
    ASSERT_GT(line.size(), 41U) << line;
    EXPECT_EQ(line[39], ' ') << line;
    EXPECT_NE(line[40], ' ') << line;
  }
  // A field a line, and no line but those.
  const learning::TaskRegistry tasks = planners::packageTrainings();
  EXPECT_EQ(tasks.names().front(), "diffusion");
  const std::string fields = core::dumpOptions(tasks.training());
  EXPECT_EQ(options, static_cast<std::size_t>(std::count(fields.begin(), fields.end(), '\n')))
      << output();
}

TEST_F(DataCommands, AWrongOptionOfTheTrainerIsNamedWithItsRange) {
  const auto train = [&](const std::string& option, const std::string& value) {
    return cdiff({"train", "--data", path("data"), "--output", path("model"), option, value});
  };
  EXPECT_EQ(train("--checkpoint-every", "soon"), 3);
  expectOutput("option --checkpoint-every: key 'checkpoint_every' is 'soon'; expected a number in");
  EXPECT_EQ(train("--image-scale", "0.7"), 3);
  expectOutput("image_scale is 0.7; expected 1 or 0.5");
  EXPECT_EQ(train("--stage", "fine-tune"), 3);
  expectOutput("did you mean 'fine_tune'?");
  for (const char* flag : {"--no-mirror", "--no-light", "--anneal-by-time"}) {
    EXPECT_EQ(train(flag, "--time-limit=1"), 3) << flag;
    expectOutput("data folder '" + path("data") + "'");
  }
  EXPECT_FALSE(fs::exists(path("model")));
}

TEST_F(DataCommands, HelpOfCollectHasDefaults) {
  EXPECT_EQ(cdiff({"collect", "--help"}), 0);
  for (const char* part : {"--seeds INT:INT in [1 - 100000]=1", "--jobs INT:INT in [1 - 64]=1",
                           "--first-seed INT:INT in [0 - 1000000000]=1", "=60"})
    expectOutput(part);
}

TEST_F(DataCommands, SessionsTooShortForASampleAreNamedAndDrivenAgain) {
  const auto collect = [&](const char* seconds) {
    return cdiff({"collect", "--scenarios", "arterial_exit", "--results", path("data"),
                  "--duration", seconds, "--set", "traffic.warm_up=5"});
  };
  // A sample needs 32 steps of 0.1 s after its image.
  EXPECT_EQ(collect("3"), 3);
  expectOutput("no session gave a sample: ");
  expectOutput("session_end");
  expectOutput("a sample needs 3.2 s of driving after its image, so longer sessions (--duration)");
  EXPECT_FALSE(fs::exists(path("data/shards/arterial_exit_seed1.shard")));
  EXPECT_EQ(collect("6"), 0);
  expectOutput("1 sessions, 0 of them already there");
  EXPECT_TRUE(fs::exists(path("data/shards/arterial_exit_seed1.shard")));
}

TEST_F(DataCommands, CollectRefusesAFolderOfResults) {
  fs::create_directories(path("data"));
  std::ofstream(path("data/matrix.yaml")) << "scenarios: [arterial_exit]\n";
  EXPECT_EQ(cdiff({"collect", "--scenarios", "arterial_exit", "--results", path("data")}), 3);
  expectOutput("holds results, see matrix.yaml");
  EXPECT_FALSE(fs::exists(path("data/runs")));
}

TEST_F(DataCommands, ScenesAreCollectedOnceAndTrainedOn) {
  const auto collect = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words = {
        "collect",    "--scenarios", "arterial_exit", "--results", path("data"),
        "--duration", "6",           "--scenes",      "--set",     "traffic.warm_up=5"};
    words.insert(words.end(), more.begin(), more.end());
    return cdiff(words);
  };
  EXPECT_EQ(collect({"--no-images"}), 0);
  expectOutput("1 scenes, ");
  const fs::path scene = path("data/scenes/arterial_exit_seed1.scene");
  EXPECT_TRUE(fs::exists(scene));
  EXPECT_FALSE(fs::exists(path("data/shards"))) << "no images, no shards";
  EXPECT_FALSE(fs::exists(path("data/bags/arterial_exit_seed1.bag"))) << "nor a bag";
  EXPECT_EQ(collect({"--no-images"}), 0);
  expectOutput("1 sessions, 1 of them already there");
  const std::string bytes = core::readFile(scene, "scene");
  EXPECT_EQ(collect({}), 0);
  expectOutput("1 sessions, 0 of them already there");
  EXPECT_TRUE(fs::exists(path("data/shards/arterial_exit_seed1.shard")));
  EXPECT_EQ(core::readFile(scene, "scene"), bytes) << "images leave the session as it is";
  EXPECT_EQ(cdiff({"train",    "--task",      "plant",    "--data",  path("data"),
                   "--output", path("model"), "--steps",  "2",       "--batch",
                   "4",        "--layers",    "1",        "--width", "32",
                   "--heads",  "2",           "--hidden", "32",      "--validation-share",
                   "0"}),
            0);
  EXPECT_TRUE(fs::exists(path("model/plant.safetensors")));
  std::ofstream(scene, std::ios::binary) << bytes.substr(0, bytes.size() / 2);
  EXPECT_EQ(cdiff({"train", "--task", "plant", "--data", path("data"), "--output", path("other")}),
            3);
  expectOutput("scene '" + scene.string() + "': truncated");
  EXPECT_EQ(collect({"--no-images"}), 0);
  expectOutput("scene '" + scene.string() + "': truncated");
  expectOutput("1 sessions, 0 of them already there");
  EXPECT_EQ(core::readFile(scene, "scene"), bytes);
}

TEST_F(DataCommands, CollectRefusesSessionsOfOtherSettings) {
  const auto collect = [&](const char* seconds, const std::vector<std::string>& more) {
    std::vector<std::string> words = {"collect",     "--scenarios", "arterial_exit",    "--results",
                                      path("data"),  "--scenes",    "--duration",       seconds,
                                      "--no-images", "--set",       "traffic.warm_up=5"};
    words.insert(words.end(), more.begin(), more.end());
    return cdiff(words);
  };
  EXPECT_EQ(collect("6", {}), 0);
  EXPECT_EQ(collect("6", {"--keep-bags"}), 0);
  expectOutput("1 sessions, 1 of them already there");
  for (const std::string other : {"traffic.warm_up=6", "collection.standing_share=0.5"}) {
    EXPECT_EQ(collect("6", {"--set", other}), 3);
    expectOutput("holds session arterial_exit_seed1 of other settings");
  }
  EXPECT_EQ(collect("7", {}), 3);
  // Nor does another kind of sample hide what is there.
  EXPECT_EQ(cdiff({"collect", "--scenarios", "arterial_exit", "--results", path("data"),
                   "--duration", "7", "--set", "traffic.warm_up=5"}),
            3);
  expectOutput("of other settings");
}

TEST_F(DataCommands, ADecisionPeriodThatSamplesDoNotHaveIsRefusedBeforeAnythingIsDriven) {
  EXPECT_EQ(cdiff({"collect", "--scenarios", "arterial_exit", "--results", path("data"), "--set",
                   "decision_period=0.2"}),
            3);
  expectOutput("key 'decision_period' is 0.2 s");
  EXPECT_FALSE(fs::exists(path("data/runs")));
}

TEST_F(DataCommands, CurvesAreDrawnOrTheirFaultIsNamed) {
  fs::create_directories(path("model"));
  EXPECT_EQ(cdiff({"report", "--training", path("model")}), 3);
  expectOutput("no curves.csv");
  std::ofstream(path("model/curves.csv"))
      << "stage,step,seconds,figure,value\njoint,1,2.0,loss,0.5\njoint,2,4.0,loss,0.4\n";
  EXPECT_EQ(cdiff({"report", "--training", path("model")}), 0);
  expectOutput("training.html");
  EXPECT_NE(core::readFile(path("model/training.html"), "page").find("<h2>joint</h2>"),
            std::string::npos);
  EXPECT_EQ(cdiff({"report", "--training", path("model"), "--tables", path("model")}), 3);
  expectOutput("give one of");
}

}  // namespace
}  // namespace cdiff::cli
