// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "core/file.h"
#include "e2e_cdiff/core/exceptions.h"
#include "learning/small_scene.h"
#include "learning/stopping_buffer.h"
#include "learning/trainer.h"
#include "learning/training_folder.h"
#include "planners/plant/training/plant_task.h"
#include "support/temporary_folder.h"

namespace cdiff::planners {
namespace {

/// Two scenes: in the second all drive twice as fast as in the first.
class PlantTaskTest : public testing::Test {
 protected:
  PlantTaskTest() {
    std::filesystem::create_directories(folder_.path() / "data");
    learning::Scene scene = test::smallScene();
    learning::writeScene(folder_.path() / "data" / "a.scene", scene);
    scene.name = "small_seed2";
    for (std::size_t i = 0; i < scene.decisions.size(); ++i) {
      for (std::size_t n = 0; n < 2; ++n) {
        traffic::VehicleState& state = scene.decisions[i].vehicles[n].state;
        state.position.x() += 0.8 * static_cast<double>(i);
        state.speed = 16.0;
      }
    }
    learning::writeScene(folder_.path() / "data" / "b.scene", scene);
  }

  learning::Training start(const std::string& output) const {
    learning::TaskRegistry tasks;
    tasks.add(plantTraining());
    learning::Training training = tasks.training("plant");
    auto& settings = dynamic_cast<PlantTask&>(*training.task).settings;
    settings.architecture.layers = 1;
    settings.architecture.width = 32;
    settings.architecture.heads = 2;
    settings.architecture.hidden = 64;
    training.options.data = (folder_.path() / "data").string();
    training.options.output = (folder_.path() / output).string();
    training.options.device = "cpu";
    training.options.steps = 120;
    training.options.batch = 16;
    training.options.warm_up = 5;
    training.options.learning_rate = 0.01;
    training.options.average_decay = 0.9;
    training.options.validation_share = 0.0;
    training.options.report_every = 0.0;
    return training;
  }
  std::string trainingText(const learning::Training& training) {
    try {
      learning::train(training, stop_, log_);
    } catch (const core::InputError& error) {
      return error.what();
    }
    return "trained";
  }
  nlohmann::json record(const std::string& folder) const {
    return nlohmann::json::parse(
        core::readFile(folder_.path() / folder / "training.json", "record"));
  }

  test::TemporaryFolder folder_;
  std::atomic<bool> stop_{false};
  std::ostringstream log_;
};

// Keeping its speed straight on is exactly what all vehicles do; standing misses by 4, 8, 12 and
// 16 m in the first scene and twice that in the second: 15 m on average, as both have as many
// samples.
TEST_F(PlantTaskTest, LearnsToDriveAsItsScenesDo) {
  EXPECT_EQ(trainingText(start("model")), "trained");
  const auto held_out = record("model").at("held_out");
  EXPECT_LT(held_out.at("ade_m").get<double>(), 3.0);
  EXPECT_NEAR(held_out.at("standing_ade_m").get<double>(), 15.0, 0.5);
  EXPECT_NEAR(held_out.at("constant_speed_ade_m").get<double>(), 0.0, 1e-5);
  const PlantModel model = readPlantModel(folder_.path() / "model");
  EXPECT_EQ(model.architecture.width, 32);
  const std::string card = core::readFile(folder_.path() / "model" / "model_card.md", "card");
  EXPECT_NE(card.find("| keeps its speed straight on | 0.000 | 0.000 |"), std::string::npos)
      << card;
}

TEST_F(PlantTaskTest, AResumedTrainingEqualsAnUninterruptedOneToTheBit) {
  learning::train(start("model"), stop_, log_);
  learning::Training other = start("resumed");
  test::StoppingBuffer buffer(stop_, "imitation step 23/120");
  std::ostream log(&buffer);
  EXPECT_THROW(learning::train(other, stop_, log), core::Interrupted);
  stop_ = false;
  other = start("resumed");
  other.options.resume = true;
  learning::train(other, stop_, log_);
  const auto expected = learning::readCheckpoint(folder_.path() / "model" / "imitation.checkpoint");
  const auto found = learning::readCheckpoint(folder_.path() / "resumed" / "imitation.checkpoint");
  for (const auto& [name, tensor] : expected.tensors)
    EXPECT_TRUE(at::equal(found.tensors.at(name), tensor)) << name;
}

TEST_F(PlantTaskTest, OtherSizesAreNoResumption) {
  learning::train(start("model"), stop_, log_);
  learning::Training other = start("model");
  other.options.resume = true;
  dynamic_cast<PlantTask&>(*other.task).settings.architecture.hidden = 128;
  EXPECT_NE(trainingText(other).find("was trained with another architecture"), std::string::npos)
      << trainingText(other);
}

TEST_F(PlantTaskTest, AFolderWithoutScenesSaysWhatToCollect) {
  learning::Training training = start("model");
  training.options.data = (folder_.path() / "none").string();
  std::filesystem::create_directories(training.options.data);
  EXPECT_EQ(trainingText(training), "training task 'plant' has no samples: data folder '" +
                                        training.options.data +
                                        "' holds no *.scene; collect them (cdiff collect --scenes) "
                                        "or give another --data");
}

TEST_F(PlantTaskTest, HasDefaultsOfItsOwn) {
  learning::TaskRegistry tasks;
  tasks.add(plantTraining());
  const learning::TrainingOptions options = tasks.training("plant").options;
  EXPECT_EQ(options.weight_decay, 0.1);
  EXPECT_EQ(options.second_decay, 0.95);
}

}  // namespace
}  // namespace cdiff::planners
