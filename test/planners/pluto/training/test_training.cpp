// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <sstream>

#include "core/file.h"
#include "learning/stopping_buffer.h"
#include "learning/task_registry.h"
#include "learning/trainer.h"
#include "learning/training_folder.h"
#include "planners/pluto/training/pluto_task.h"
#include "planners/pluto/training/small_scene.h"
#include "support/temporary_folder.h"

namespace cdiff::planners {
namespace {

/// Two sessions of the small scene, and a small network.
class PlutoTraining : public ::testing::Test {
 protected:
  PlutoTraining() {
    for (const char* name : {"one", "two"}) {
      const auto file = folder_.path() / "data" / (std::string(name) + ".scene");
      std::filesystem::create_directories(file.parent_path());
      learning::writeScene(file, testing::smallScene(name, 12.0));
    }
  }
  learning::Training start(const std::string& output) const {
    learning::TaskRegistry tasks;
    tasks.add(plutoTraining());
    learning::Training training = tasks.training("pluto");
    dynamic_cast<PlutoTask&>(*training.task).settings.architecture = testing::smallPluto();
    training.options.data = (folder_.path() / "data").string();
    training.options.output = (folder_.path() / output).string();
    training.options.device = "cpu";
    training.options.steps = 120;
    training.options.batch = 4;
    training.options.warm_up = 5;
    training.options.validation_share = 0.5;
    training.options.validation_samples = 10;
    training.options.report_every = 0.0;
    return training;
  }
  double measure(const std::string& output, const char* name) const {
    const auto path = learning::checkpointPath((folder_.path() / output).string(), "imitation");
    return learning::readCheckpoint(path).facts.at("held_out").at(name).get<double>();
  }

  test::TemporaryFolder folder_;
  std::atomic<bool> stop_{false};
  std::ostringstream log_;
};

TEST_F(PlutoTraining, LearnsToDriveOn) {
  learning::train(start("model"), stop_, log_);
  const PlutoModel model = readPlutoModel(kPluto, folder_.path() / "model");
  EXPECT_EQ(model.architecture.width, 16);
  EXPECT_EQ(model.weights.size(), plutoTensors(model.architecture).size());
  // Of vehicles that drive 5 to 7 m/s straight on, the plans must beat a standing one.
  EXPECT_LT(measure("model", "best_score_ade_m"), 0.5 * measure("model", "standing_ade_m"));
  EXPECT_LE(measure("model", "nearest_ade_m"), measure("model", "best_score_ade_m"));
  EXPECT_NEAR(measure("model", "constant_speed_ade_m"), 0.0, 1e-4);
  EXPECT_NE(log_.str().find("contrast"), std::string::npos) << "in the last third";
  const std::string card = core::readFile(folder_.path() / "model" / "model_card.md", "card");
  EXPECT_NE(card.find("| that drives (RIFT's choice) |"), std::string::npos) << card;
}

TEST_F(PlutoTraining, AResumedTrainingEqualsAnUninterruptedOneToTheBit) {
  learning::Training whole = start("whole");
  whole.options.steps = 12;
  learning::train(whole, stop_, log_);
  learning::Training parted = start("parted");
  parted.options.steps = 12;
  test::StoppingBuffer buffer(stop_, "imitation step 9/12");
  std::ostream log(&buffer);
  EXPECT_THROW(learning::train(parted, stop_, log), core::Interrupted);
  stop_ = false;
  parted = start("parted");
  parted.options.steps = 12;
  parted.options.resume = true;
  learning::train(parted, stop_, log_);
  const auto first = readPlutoModel(kPluto, folder_.path() / "whole");
  const auto second = readPlutoModel(kPluto, folder_.path() / "parted");
  for (const auto& [name, tensor] : first.weights)
    EXPECT_EQ(tensor.values, second.weights.at(name).values) << name;
}

}  // namespace
}  // namespace cdiff::planners
