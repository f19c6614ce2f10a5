// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "learning/small_scene.h"
#include "learning/training_fixture.h"
#include "planners/vad_mini/training/vad_mini_task.h"

namespace cdiff::planners {
namespace {

/// Two sessions of the small scene, and a small network.
class VadMiniTraining : public test::TrainingFixture {
 protected:
  VadMiniTraining() {
    for (const char* name : {"one", "two"}) test::writePlatoonScene(path("data"), name, 7.0);
  }
  learning::Training start(const std::string& output, std::int64_t steps) const {
    learning::Training training = trainingOf(vadMiniTraining(), output);
    auto& settings = dynamic_cast<VadMiniTask&>(*training.task).settings;
    settings.architecture.ego.width = 32;
    settings.architecture.ego.heads = 2;
    settings.architecture.ego.hidden = 32;
    settings.architecture.ego.bev_layers = 1;
    settings.architecture.ego.bev.rows = 20;
    settings.architecture.ego.bev.columns = 10;
    settings.architecture.ego.bev.cell = 3.0;
    settings.architecture.decoder_layers = 1;
    settings.architecture.map_lines = 6;
    training.options.steps = steps;
    training.options.batch = 4;
    training.options.warm_up = 5;
    training.options.learning_rate = 2e-3;
    training.options.average_decay = 0.9;
    training.options.validation_share = 0.5;
    training.options.validation_samples = 6;
    return training;
  }
  double measure(const std::string& output, const char* name) const {
    return checkpoint(output, "imitation").facts.at("held_out").at(name).get<double>();
  }
};

// Vehicles that drive 5 to 7 m/s straight on are 15 to 21 m ahead after 3 s.
TEST_F(VadMiniTraining, LearnsToDriveOn) {
  train(start("model", 120));
  EXPECT_LT(measure("model", "l2_at_3s_m"), 9.0) << "standing still: 15 to 21 m";
  EXPECT_NEAR(measure("model", "constant_velocity_l2_at_3s_m"), 0.0, 1e-4);
  EXPECT_LT(measure("model", "l2_to_3s_m"), measure("model", "l2_at_3s_m"));
  EXPECT_NE(log_.str().find("plan_boundary"), std::string::npos) << "in the last 60 %";
  const VadMiniModel model = readVadMiniModel(path("model"));
  EXPECT_EQ(model.architecture.ego.width, 32);
  EXPECT_NE(text("model", "model_card.md").find("| keeps its velocity |"), std::string::npos);
}

TEST_F(VadMiniTraining, AResumedTrainingEqualsAnUninterruptedOneToTheBit) {
  train(start("whole", 8));
  trainUntil(start("parted", 8), "imitation step 5/8");
  learning::Training again = start("parted", 8);
  again.options.resume = true;
  train(again);
  expectSameCheckpoints("whole", "parted", "imitation");
}

TEST_F(VadMiniTraining, AblationsLeaveOutWhatTheySay) {
  learning::Training training = start("bare", 6);
  auto& settings = dynamic_cast<VadMiniTask&>(*training.task).settings;
  settings.intermediate_losses = false;
  settings.architecture.ego.past_bev = false;
  settings.samples.blind = true;
  train(training);
  EXPECT_EQ(log_.str().find("agent_box"), std::string::npos);
  EXPECT_EQ(log_.str().find("plan_collision"), std::string::npos);
  EXPECT_FALSE(readVadMiniModel(path("bare")).architecture.ego.past_bev);
  learning::Training other = start("bare", 6);
  other.options.resume = true;
  EXPECT_NE(trainingText(other).find("was trained with another"), std::string::npos);
}

}  // namespace
}  // namespace cdiff::planners
