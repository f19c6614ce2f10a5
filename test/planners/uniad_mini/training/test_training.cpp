// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "learning/small_scene.h"
#include "learning/training_fixture.h"
#include "planners/uniad_mini/training/uniad_mini_task.h"
#include "support/random_model.h"

namespace cdiff::planners {
namespace {

/// Two sessions of the small scene, and a small network.
class UniadMiniTraining : public test::TrainingFixture {
 protected:
  UniadMiniTraining() {
    for (const char* name : {"one", "two"}) test::writePlatoonScene(path("data"), name, 7.0);
  }
  learning::Training start(const std::string& output, std::int64_t steps) const {
    learning::Training training = trainingOf(uniadMiniTraining(), output);
    auto& settings = dynamic_cast<UniadMiniTask&>(*training.task).settings;
    settings.architecture.ego.width = 32;
    settings.architecture.ego.heads = 2;
    settings.architecture.ego.hidden = 32;
    settings.architecture.ego.bev_layers = 1;
    settings.architecture.ego.bev = {16, 16, 4.0, 16.0};
    settings.architecture.decoder_layers = 1;
    settings.architecture.motion_layers = 1;
    settings.architecture.plan_layers = 1;
    settings.architecture.tracks = 8;
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
  double measure(const std::string& output, const char* stage, const char* name) const {
    return checkpoint(output, stage).facts.at("held_out").at(name).get<double>();
  }
};

// Vehicles that drive 5 to 7 m/s straight on are 15 to 21 m ahead after 3 s.
TEST_F(UniadMiniTraining, LearnsToDriveOnInTwoStages) {
  learning::Training training = start("model", 120);
  training.options.stage = "all";
  train(training);
  EXPECT_LT(measure("model", "end_to_end", "l2_at_3s_m"), 9.0) << "standing still: 15 to 21 m";
  EXPECT_LT(measure("model", "end_to_end", "l2_at_3s_m"),
            measure("model", "perception", "l2_at_3s_m"));
  EXPECT_NEAR(measure("model", "end_to_end", "constant_velocity_l2_at_3s_m"), 0.0, 1e-4);
  EXPECT_NE(log_.str().find("occupancy"), std::string::npos);
  const UniadMiniModel model = readUniadMiniModel(path("model"));
  EXPECT_EQ(model.architecture.tracks, 8);
  // Anchors are what the vehicles drove: all straight on, the fastest 15 to 21 m.
  const auto anchors = toAnchors(model.weights.at(kAnchorTable));
  EXPECT_GT(anchors[0][5].back().x(), 14.0);
  EXPECT_LT(anchors[0][5].back().x(), 22.0);
  EXPECT_NEAR(anchors[0][5].back().y(), 0.0, 0.5);
  EXPECT_NE(text("model", "model_card.md").find("| UniAD mini |"), std::string::npos);
}

TEST_F(UniadMiniTraining, TheSecondStageLeavesTheBevAsItIs) {
  learning::Training first = start("staged", 4);
  first.options.stage = "perception";
  train(first);
  EXPECT_NE(log_.str().find("train stage end_to_end"), std::string::npos) << "no model yet";
  learning::Training second = start("staged", 4);
  second.options.stage = "end_to_end";
  train(second);
  const auto holds = [&](const char* stage, const char* part) {
    for (const auto& [name, tensor] : checkpoint("staged", stage).tensors) {
      if (name.find(part) != std::string::npos) return true;
    }
    return false;
  };
  EXPECT_TRUE(holds("perception", "table.bev.query"));
  EXPECT_FALSE(holds("end_to_end", "table.bev.query")) << "frozen";
  EXPECT_TRUE(holds("end_to_end", "plan.way.out.weight"));
  EXPECT_FALSE(holds("perception", "plan.way.out.weight"));
  EXPECT_NO_THROW(readUniadMiniModel(path("staged"))) << "now there is a model";
}

TEST_F(UniadMiniTraining, TheSecondStageNeedsTheFirst) {
  learning::Training second = start("none", 4);
  second.options.stage = "end_to_end";
  EXPECT_NE(trainingText(second).find("train stage 'perception' first"), std::string::npos);
}

TEST_F(UniadMiniTraining, AResumedTrainingEqualsAnUninterruptedOneToTheBit) {
  const auto perception = [&](const char* output) {
    learning::Training training = start(output, 6);
    training.options.stage = "perception";
    return training;
  };
  train(perception("whole"));
  trainUntil(perception("parted"), "perception step 4/6");
  learning::Training again = perception("parted");
  again.options.resume = true;
  train(again);
  expectSameCheckpoints("whole", "parted", "perception");
}

// Of a vad_mini whose BEV is narrower; weights are kept in half precision.
TEST_F(UniadMiniTraining, StartsFromTheBevEncoderOfAVadMini) {
  learning::Training training = start("from_vad", 2);
  training.options.stage = "end_to_end";
  training.options.init = path("vad").string();
  VadMiniArchitecture vad;
  vad.ego = dynamic_cast<UniadMiniTask&>(*training.task).settings.architecture.ego;
  vad.ego.bev.columns = 8;
  const WeightTensors weights = testing::randomTensors(vadMiniTensors(vad));
  std::filesystem::create_directories(path("vad"));
  inference::writeSafetensors(path("vad") / kVadMini.file,
                              {networkMetadata(kVadMini, vad), weights},
                              inference::TensorType::kF16);
  train(training);
  const UniadMiniModel model = readUniadMiniModel(path("from_vad"));
  const float expected = weights.at("stem.conv.weight").values[0];
  EXPECT_NEAR(model.weights.at("stem.conv.weight").values[0], expected, 1e-3 * std::abs(expected));
  EXPECT_NE(text("from_vad", "model_card.md").find("BEV encoder of vad_mini, "), std::string::npos);
}

TEST_F(UniadMiniTraining, AblationsLeaveOutWhatTheySay) {
  learning::Training training = start("bare", 4);
  training.options.stage = "all";
  auto& settings = dynamic_cast<UniadMiniTask&>(*training.task).settings;
  settings.intermediate_losses = false;
  settings.architecture.ego.past_bev = false;
  settings.samples.blind = true;
  train(training);
  EXPECT_NE(log_.str().find("track_box"), std::string::npos) << "in the first stage";
  EXPECT_NE(log_.str().find(" plan_collision "), std::string::npos);
  EXPECT_EQ(log_.str().find(" occupancy "), std::string::npos);
  EXPECT_FALSE(readUniadMiniModel(path("bare")).architecture.ego.past_bev);
}

}  // namespace
}  // namespace cdiff::planners
