// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "learning/samples/scene_file.h"
#include "learning/small_scene.h"
#include "learning/training_fixture.h"
#include "planners/plant/training/plant_task.h"

namespace cdiff::planners {
namespace {

/// Two scenes: in the second all drive twice as fast as in the first.
class PlantTaskTest : public test::TrainingFixture {
 protected:
  PlantTaskTest() {
    learning::Scene scene = test::smallScene();
    learning::writeScene(path("data") / "a.scene", scene);
    scene.name = "small_seed2";
    for (std::size_t i = 0; i < scene.decisions.size(); ++i) {
      for (std::size_t n = 0; n < 2; ++n) {
        traffic::VehicleState& state = scene.decisions[i].vehicles[n].state;
        state.position.x() += 0.8 * static_cast<double>(i);
        state.speed = 16.0;
      }
    }
    learning::writeScene(path("data") / "b.scene", scene);
  }

  learning::Training start(const std::string& output) const {
    learning::Training training = trainingOf(plantTraining(), output);
    auto& settings = dynamic_cast<PlantTask&>(*training.task).settings;
    settings.architecture.layers = 1;
    settings.architecture.width = 32;
    settings.architecture.heads = 2;
    settings.architecture.hidden = 64;
    training.options.steps = 120;
    training.options.batch = 16;
    training.options.warm_up = 5;
    training.options.learning_rate = 0.01;
    training.options.average_decay = 0.9;
    training.options.validation_share = 0.0;
    return training;
  }
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
  const PlantModel model = readPlantModel(path("model"));
  EXPECT_EQ(model.architecture.width, 32);
  const std::string card = text("model", "model_card.md");
  EXPECT_NE(card.find("| keeps its speed straight on | 0.000 | 0.000 |"), std::string::npos)
      << card;
}

TEST_F(PlantTaskTest, AResumedTrainingEqualsAnUninterruptedOneToTheBit) {
  train(start("model"));
  trainUntil(start("resumed"), "imitation step 23/120");
  learning::Training other = start("resumed");
  other.options.resume = true;
  train(other);
  expectSameCheckpoints("model", "resumed", "imitation");
}

TEST_F(PlantTaskTest, OtherSizesAreNoResumption) {
  train(start("model"));
  learning::Training other = start("model");
  other.options.resume = true;
  dynamic_cast<PlantTask&>(*other.task).settings.architecture.hidden = 128;
  EXPECT_NE(trainingText(other).find("was trained with another architecture"), std::string::npos)
      << trainingText(other);
}

TEST_F(PlantTaskTest, AFolderWithoutScenesSaysWhatToCollect) {
  learning::Training training = start("model");
  training.options.data = path("none").string();
  std::filesystem::create_directories(training.options.data);
  EXPECT_EQ(trainingText(training), "training task 'plant' has no samples: data folder '" +
                                        training.options.data +
                                        "' holds no *.scene; collect them (cdiff collect --scenes) "
                                        "or give another --data");
}

TEST_F(PlantTaskTest, HasDefaultsOfItsOwn) {
  const learning::TrainingOptions options = trainingOf(plantTraining(), "model").options;
  EXPECT_EQ(options.weight_decay, 0.1);
  EXPECT_EQ(options.second_decay, 0.95);
}

}  // namespace
}  // namespace cdiff::planners
