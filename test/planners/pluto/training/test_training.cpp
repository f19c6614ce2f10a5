// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "learning/small_scene.h"
#include "learning/training_fixture.h"
#include "planners/pluto/pluto_course.h"
#include "planners/pluto/training/pluto_task.h"

namespace cdiff::planners {
namespace {

/// Two sessions of the small scene, and a small network.
class PlutoTraining : public test::TrainingFixture {
 protected:
  PlutoTraining() {
    for (const char* name : {"one", "two"}) test::writePlatoonScene(path("data"), name, 12.0);
  }
  learning::Training start(const std::string& output) const {
    learning::Training training = trainingOf(plutoTraining(), output);
    dynamic_cast<PlutoTask&>(*training.task).settings.architecture = testing::smallPluto();
    training.options.steps = 120;
    training.options.batch = 4;
    training.options.warm_up = 5;
    training.options.validation_share = 0.5;
    training.options.validation_samples = 10;
    return training;
  }
  double measure(const std::string& output, const char* name) const {
    return checkpoint(output, "imitation").facts.at("held_out").at(name).get<double>();
  }
};

TEST_F(PlutoTraining, LearnsToDriveOn) {
  train(start("model"));
  const PlutoModel model = readPlutoModel(kPluto, path("model"));
  EXPECT_EQ(model.architecture.width, 16);
  EXPECT_EQ(model.weights.size(), plutoTensors(model.architecture).size());
  // Of vehicles that drive 5 to 7 m/s straight on, the plans must beat a standing one.
  EXPECT_LT(measure("model", "best_score_ade_m"), 0.5 * measure("model", "standing_ade_m"));
  EXPECT_LE(measure("model", "nearest_ade_m"), measure("model", "best_score_ade_m"));
  EXPECT_NEAR(measure("model", "constant_speed_ade_m"), 0.0, 1e-4);
  EXPECT_NE(log_.str().find("contrast"), std::string::npos) << "in the last third";
  const std::string card = text("model", "model_card.md");
  EXPECT_NE(card.find("| that drives (RIFT's choice) |"), std::string::npos) << card;
}

TEST_F(PlutoTraining, AResumedTrainingEqualsAnUninterruptedOneToTheBit) {
  const auto twelveSteps = [&](const char* output) {
    learning::Training training = start(output);
    training.options.steps = 12;
    return training;
  };
  train(twelveSteps("whole"));
  trainUntil(twelveSteps("parted"), "imitation step 9/12");
  learning::Training again = twelveSteps("parted");
  again.options.resume = true;
  train(again);
  expectSameCheckpoints("whole", "parted", "imitation");
}

}  // namespace
}  // namespace cdiff::planners
