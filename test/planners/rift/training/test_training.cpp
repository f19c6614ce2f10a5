// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "learning/small_scene.h"
#include "learning/training_fixture.h"
#include "planners/pluto/pluto_course.h"
#include "planners/rift/training/rift_stage.h"

namespace cdiff::planners {
namespace {

/// Two sessions of the small scene, and a small Pluto with random weights. Buffers of 24 states,
/// two passes in batches of 8: 6 steps each.
class RiftTraining : public test::TrainingFixture {
 protected:
  RiftTraining() {
    for (const char* name : {"one", "two"}) test::writePlatoonScene(path("data"), name, 6.0);
    testing::writePluto(init(), kPluto, kPluto.format, testing::smallPluto());
  }
  std::filesystem::path init() const { return path("pluto"); }
  learning::Training start(const std::string& output, const std::string& objective = "rift") {
    learning::Training training = trainingOf(riftTraining(), output);
    RiftTrainingSettings& settings = dynamic_cast<RiftTask&>(*training.task).settings;
    settings.buffer = 24;
    settings.epochs = 2;
    settings.objective = objective;
    training.options.init = init().string();
    training.options.steps = 18;
    training.options.batch = 8;
    training.options.learning_rate = 1e-2;
    training.options.validation_share = 0.5;
    training.options.validation_samples = 10;
    return training;
  }
  nlohmann::json heldOut(const std::string& output) const {
    return checkpoint(output, kRiftStage).facts.at("held_out");
  }
};

TEST_F(RiftTraining, RaisesTheExpectedReturnAndTouchesTheScoreHeadAlone) {
  train(start("model"));
  const auto held_out = heldOut("model");
  EXPECT_GT(held_out.at("expected_return").get<double>(),
            held_out.at("pluto_expected_return").get<double>());
  EXPECT_GE(held_out.at("largest_return").get<double>(), held_out.at("best_return").get<double>());
  const PlutoModel before = readPlutoModel(kPluto, init());
  const PlutoModel after = readPlutoModel(kRift, path("model"));
  for (const auto& [name, tensor] : before.weights)
    EXPECT_EQ(tensor.values == after.weights.at(name).values, !ofScoreHead(name)) << name;
}

TEST_F(RiftTraining, TheOtherObjectiveTrainsToo) {
  train(start("model", "grpo"));
  EXPECT_NE(text("model", "training.json").find("grpo"), std::string::npos);
}

// Interrupted at step 9, in the middle of the second buffer: it stops at that buffer's end.
TEST_F(RiftTraining, AResumedTrainingGoesOnFromTheLastWholeBuffer) {
  train(start("whole"));
  trainUntil(start("parted"), "fine_tune step 9/18");
  EXPECT_EQ(checkpoint("parted", kRiftStage).facts.at("steps"), 12);
  learning::Training again = start("parted");
  again.options.resume = true;
  train(again);
  expectSameCheckpoints("whole", "parted", kRiftStage);
}

TEST_F(RiftTraining, StepsMustMakeWholeBuffers) {
  learning::Training training = start("model");
  training.options.steps = 20;
  EXPECT_EQ(trainingText(training),
            "steps is 20; a multiple of 6, the steps of a buffer, was expected");
}

TEST_F(RiftTraining, WithoutWeightsItNamesThem) {
  learning::Training training = start("model");
  training.options.init = path("none").string();
  EXPECT_NE(trainingText(training).find("planner 'pluto' has no weights"), std::string::npos);
}

TEST_F(RiftTraining, AnotherObjectiveIsNoResumption) {
  train(start("model"));
  learning::Training other = start("model", "grpo");
  other.options.resume = true;
  EXPECT_NE(trainingText(other).find("--resume cannot go on from it"), std::string::npos);
}

// Three vehicles are driven, at target speeds of 5, 6 and 7 m/s, over decisions 0 to 60. Every
// fifth is a state: the ego's at 0, 5 ... 60, those of "a" at 4, 9 ... 59.
TEST(RiftMoments, DriversWithAnotherTargetSpeedAreLeftOut) {
  const learning::Scene recorded = test::platoonScene("small", 6.0);
  PlutoWorlds worlds(testing::smallPluto());
  const PlutoScene scene(recorded, worlds.of(recorded));
  learning::SceneSampleOptions options;
  EXPECT_EQ(riftMoments(recorded, scene, 0, options).size(), 13U + 12U + 12U);
  options.lowest_speed = 5.5;
  options.highest_speed = 6.5;
  const std::vector<RiftMoment> chosen = riftMoments(recorded, scene, 0, options);
  EXPECT_EQ(chosen.size(), 12U);
  for (const RiftMoment& moment : chosen) EXPECT_EQ(moment.place.drive, 1U);
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
