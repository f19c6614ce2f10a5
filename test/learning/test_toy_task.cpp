// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// A task goes all the way: trained, judged, interrupted, resumed, exported. The library knows
// nothing of it but its interface.
#include "learning/task.h"
#include "learning/toy_task.h"
#include "learning/training_fixture.h"

namespace cdiff::learning {
namespace {

class ToyTaskTest : public test::TrainingFixture {
 protected:
  ToyTaskTest() {
    test::writeToyShard(path("data") / "a.shard", 100);
    training_ = start("model");
  }

  Training start(const std::string& output) const {
    Training training = trainingOf(test::toyTraining(), output);
    training.options.steps = 300;
    training.options.warm_up = 5;
    training.options.learning_rate = 0.05;
    training.options.weight_decay = 0.0;
    training.options.average_decay = 0.9;
    training.options.validation_share = 0.2;
    training.options.validation_every = 100;
    return training;
  }
  inference::SafetensorsFile model(const std::string& folder) const {
    return inference::readSafetensors(path(folder) / "line.safetensors",
                                      [](const auto&) -> std::vector<inference::TensorShape> {
                                        return {{"line.bias", {1}}, {"line.weight", {1, 2}}};
                                      });
  }

  Training training_;
};

TEST_F(ToyTaskTest, LearnsTheLineJudgesItAndExportsIt) {
  train(training_);
  const inference::SafetensorsFile found = model("model");
  // The line that the samples lie on; F16 holds its coefficients to 1e-3.
  EXPECT_NEAR(found.tensors.at("line.weight").values[0], 2.0F, 0.02F);
  EXPECT_NEAR(found.tensors.at("line.weight").values[1], -3.0F, 0.02F);
  EXPECT_NEAR(found.tensors.at("line.bias").values[0], 1.0F, 0.02F);
  EXPECT_EQ(found.metadata.at("format"), "toy");
  const auto written = record("model");
  EXPECT_EQ(nlohmann::json::parse(found.metadata.at("training")), written);
  EXPECT_EQ(written.at("stages").at("fit").at("steps"), 300);
  EXPECT_EQ(written.at("slope"), 1.0);
  EXPECT_EQ(written.at("data").at("samples"), 100);
  EXPECT_LT(written.at("held_out").at("square").get<double>(), 1e-3);
  const std::string curves = text("model", "curves.csv");
  for (const char* row : {"fit,100,", "fit,300,", "held_out_square", "loss_square"})
    EXPECT_NE(curves.find(row), std::string::npos) << row;
  const std::string card = text("model", "model_card.md");
  EXPECT_EQ(card.rfind("# A line\n", 0), 0U) << card;
  EXPECT_NE(card.find("| fit | 300 |"), std::string::npos) << card;
}

TEST_F(ToyTaskTest, AResumedTrainingEqualsAnUninterruptedOneToTheBit) {
  train(training_);
  Training other = start("resumed");
  trainUntil(other, "fit step 123/300");
  EXPECT_EQ(checkpoint("resumed", "fit").facts.at("steps"), 123);
  EXPECT_FALSE(std::filesystem::exists(path("resumed") / "line.safetensors"));
  other.options.resume = true;
  train(other);
  EXPECT_EQ(checkpoint("resumed", "fit").tensors.size(), 8U)
      << "weight, two moments and average of two tensors";
  expectSameCheckpoints("model", "resumed", "fit");
  EXPECT_EQ(model("resumed").metadata.at("sha256"), model("model").metadata.at("sha256"));
}

TEST_F(ToyTaskTest, ExportWritesTheModelAnew) {
  train(training_);
  const std::string hash = model("model").metadata.at("sha256");
  std::filesystem::remove(path("model") / "line.safetensors");
  training_.options.stage = "export";
  train(training_);
  EXPECT_EQ(model("model").metadata.at("sha256"), hash);
  Training empty = start("empty");
  empty.options.stage = "export";
  EXPECT_NE(trainingText(empty).find("holds no checkpoint of a line; train stage 'fit' first"),
            std::string::npos);
}

TEST_F(ToyTaskTest, AnotherSettingOfTheTaskIsNoResumption) {
  train(training_);
  Training other = start("model");
  other.options.resume = true;
  EXPECT_EQ(trainingText(other), "trained");
  core::overrideOption("slope=2", "option", other);
  EXPECT_NE(trainingText(other).find("was trained with slope 1.0, this run has 2.0"),
            std::string::npos);
}

TEST_F(ToyTaskTest, AFieldThatTheSamplesLackIsNamed) {
  auto& task = dynamic_cast<test::ToyTask&>(*training_.task);
  task.needed = {"inputs", "boxes"};
  const std::string text = trainingText(training_);
  EXPECT_NE(text.find("training task 'toy' needs the field 'boxes' of the samples, which data "
                      "folder '" +
                      training_.options.data +
                      "' lacks (it holds session, inputs, target); collect samples with that"),
            std::string::npos)
      << text;
  task.needed.clear();
  EXPECT_NE(trainingText(training_).find("training task 'toy' learns from no field"),
            std::string::npos);
}

TEST_F(ToyTaskTest, ATaskWithoutSamplesSaysWhoMustCollect) {
  training_.options.data = path("none").string();
  std::filesystem::create_directories(training_.options.data);
  EXPECT_NE(trainingText(training_).find("training task 'toy' has no samples: data folder '" +
                                         training_.options.data + "' holds no *.shard; collect"),
            std::string::npos)
      << trainingText(training_);
  test::writeToyShard(std::filesystem::path(training_.options.data) / "empty.shard", 0);
  EXPECT_NE(trainingText(training_).find("its shards hold no samples; collect longer sessions"),
            std::string::npos)
      << trainingText(training_);
}

TEST_F(ToyTaskTest, AGpuThatIsNotThereIsRefused) {
  if (at::hasCUDA()) GTEST_SKIP() << "libtorch finds a GPU here";
  training_.options.device = "cuda";
  EXPECT_NE(trainingText(training_).find("device is 'cuda', but libtorch finds none here; choose"),
            std::string::npos)
      << trainingText(training_);
  EXPECT_FALSE(std::filesystem::exists(path("model")));
}

TEST_F(ToyTaskTest, AStageOfAnotherTaskIsRefused) {
  training_.options.stage = "encoder";
  EXPECT_NE(trainingText(training_).find("'encoder'; expected one of"), std::string::npos)
      << trainingText(training_);
}

}  // namespace
}  // namespace cdiff::learning
