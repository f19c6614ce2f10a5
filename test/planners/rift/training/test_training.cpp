// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <sstream>

#include "core/file.h"
#include "learning/stopping_buffer.h"
#include "learning/task_registry.h"
#include "learning/trainer.h"
#include "learning/training_folder.h"
#include "planners/pluto/training/small_scene.h"
#include "planners/rift/training/rift_stage.h"
#include "support/random_model.h"
#include "support/temporary_folder.h"

namespace cdiff::planners {
namespace {

/// Two sessions of the small scene, and a small Pluto with random weights. Buffers of 24 states,
/// two passes in batches of 8: 6 steps each.
class RiftTraining : public ::testing::Test {
 protected:
  RiftTraining() {
    for (const char* name : {"one", "two"}) {
      const auto file = folder_.path() / "data" / (std::string(name) + ".scene");
      std::filesystem::create_directories(file.parent_path());
      learning::writeScene(file, testing::smallScene(name, 6.0));
    }
    std::filesystem::create_directories(init());
    const PlutoArchitecture sizes = testing::smallPluto();
    inference::writeSafetensors(
        init() / kPluto.file,
        {networkMetadata(kPluto, sizes), cdiff::testing::randomTensors(plutoTensors(sizes))},
        inference::TensorType::kF16);
  }
  std::filesystem::path init() const { return folder_.path() / "pluto"; }
  learning::Training start(const std::string& output, const std::string& objective = "rift") {
    learning::TaskRegistry tasks;
    tasks.add(riftTraining());
    learning::Training training = tasks.training("rift");
    RiftTrainingSettings& settings = dynamic_cast<RiftTask&>(*training.task).settings;
    settings.buffer = 24;
    settings.epochs = 2;
    settings.objective = objective;
    training.options.data = (folder_.path() / "data").string();
    training.options.output = (folder_.path() / output).string();
    training.options.init = init().string();
    training.options.device = "cpu";
    training.options.steps = 18;
    training.options.batch = 8;
    training.options.learning_rate = 1e-2;
    training.options.validation_share = 0.5;
    training.options.validation_samples = 10;
    training.options.report_every = 0.0;
    return training;
  }
  nlohmann::json heldOut(const std::string& output) const {
    const auto path = learning::checkpointPath((folder_.path() / output).string(), kRiftStage);
    return learning::readCheckpoint(path).facts.at("held_out");
  }
  std::string errorOf(const learning::Training& training) {
    try {
      learning::train(training, stop_, log_);
    } catch (const core::InputError& error) {
      return error.what();
    }
    return "trained";
  }

  test::TemporaryFolder folder_;
  std::atomic<bool> stop_{false};
  std::ostringstream log_;
};

TEST_F(RiftTraining, RaisesTheExpectedReturnAndTouchesTheScoreHeadAlone) {
  learning::train(start("model"), stop_, log_);
  const auto held_out = heldOut("model");
  EXPECT_GT(held_out.at("expected_return").get<double>(),
            held_out.at("pluto_expected_return").get<double>());
  EXPECT_GE(held_out.at("largest_return").get<double>(), held_out.at("best_return").get<double>());
  const PlutoModel before = readPlutoModel(kPluto, init());
  const PlutoModel after = readPlutoModel(kRift, folder_.path() / "model");
  for (const auto& [name, tensor] : before.weights)
    EXPECT_EQ(tensor.values == after.weights.at(name).values, !ofScoreHead(name)) << name;
}

TEST_F(RiftTraining, TheOtherObjectiveTrainsToo) {
  learning::train(start("model", "grpo"), stop_, log_);
  EXPECT_NE(core::readFile(folder_.path() / "model" / "training.json", "record").find("grpo"),
            std::string::npos);
}

// Interrupted at step 9, in the middle of the second buffer: it goes on from step 6.
TEST_F(RiftTraining, AResumedTrainingGoesOnFromTheLastWholeBuffer) {
  learning::train(start("whole"), stop_, log_);
  test::StoppingBuffer buffer(stop_, "fine_tune step 9/18");
  std::ostream log(&buffer);
  EXPECT_THROW(learning::train(start("parted"), stop_, log), core::Interrupted);
  const auto path = learning::checkpointPath((folder_.path() / "parted").string(), kRiftStage);
  EXPECT_EQ(learning::readCheckpoint(path).facts.at("steps"), 6);
  stop_ = false;
  learning::Training again = start("parted");
  again.options.resume = true;
  learning::train(again, stop_, log_);
  const PlutoModel first = readPlutoModel(kRift, folder_.path() / "whole");
  const PlutoModel second = readPlutoModel(kRift, folder_.path() / "parted");
  for (const auto& [name, tensor] : first.weights)
    EXPECT_EQ(tensor.values, second.weights.at(name).values) << name;
}

TEST_F(RiftTraining, StepsMustMakeWholeBuffers) {
  learning::Training training = start("model");
  training.options.steps = 20;
  EXPECT_EQ(errorOf(training), "steps is 20; a multiple of 6, the steps of a buffer, was expected");
}

TEST_F(RiftTraining, WithoutWeightsItNamesThem) {
  learning::Training training = start("model");
  training.options.init = (folder_.path() / "none").string();
  EXPECT_NE(errorOf(training).find("planner 'pluto' has no weights"), std::string::npos);
}

TEST_F(RiftTraining, AnotherObjectiveIsNoResumption) {
  learning::train(start("model"), stop_, log_);
  learning::Training other = start("model", "grpo");
  other.options.resume = true;
  EXPECT_NE(errorOf(other).find("--resume cannot go on from it"), std::string::npos);
}

// Rates within a buffer of 32 steps (16 epochs of 2): warm-up over 6 steps, then from 1e-4 down to
// 0.9e-4; the next buffer has 0.9 of that.
TEST(RiftRate, FallsWithinABufferAndFromBufferToBuffer) {
  const auto at = [](std::int64_t step) { return riftRate(1e-4, step, 2, 16); };
  EXPECT_NEAR(at(0), 1e-4 / 6.0, 1e-12);
  EXPECT_NEAR(at(5), 1e-4, 1e-12);
  EXPECT_NEAR(at(6), 1e-4, 1e-12);
  EXPECT_NEAR(at(19), 0.95e-4, 1e-12) << "halfway";
  EXPECT_NEAR(at(32 + 5), 0.9e-4, 1e-12);
  EXPECT_NEAR(at(32 * 60 + 5), 1e-6, 1e-12) << "not below";
}

}  // namespace
}  // namespace cdiff::planners
