// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "core/file.h"
#include "diffusion/model.h"
#include "e2e_cdiff/core/exceptions.h"
#include "training/checkpoint.h"
#include "training/small_samples.h"
#include "training/trainer.h"

namespace cdiff::training {
namespace {

/// Eight samples, small networks, every sample in every batch.
class TrainerTest : public testing::Test {
 protected:
  TrainerTest() {
    std::filesystem::create_directories(folder_.path() / "data");
    test::writeShard(folder_.path() / "data" / "a.shard", 8);
    options_.data = (folder_.path() / "data").string();
    options_.output = (folder_.path() / "model").string();
    options_.architecture = test::smallArchitecture();
    options_.validation_share = 0.0;
    options_.batch = 8;
    options_.device = "cpu";
    options_.warm_up = 5;
    options_.learning_rate = 2e-3;
    options_.validation_every = 100000;
    options_.report_every = 0.0;
  }

  void run(const std::string& stage, std::int64_t steps) {
    options_.stage = stage;
    options_.steps = steps;
    train(options_, stop_, log_);
  }
  /// What a run that is refused says.
  std::string refusal(const std::string& stage) {
    try {
      run(stage, 1);
    } catch (const core::InputError& error) {
      return error.what();
    }
    return "trained";
  }
  std::filesystem::path output(const std::string& name) const {
    return std::filesystem::path(options_.output) / name;
  }
  std::int64_t stepsOf(const std::string& stage) const {
    return readCheckpoint(output(stage + ".checkpoint")).facts.at("steps");
  }

  test::TemporaryFolder folder_;
  TrainingOptions options_;
  std::atomic<bool> stop_{false};
  std::ostringstream log_;
};

TEST_F(TrainerTest, AllStagesMakeAModelThatFitsEightSamples) {
  options_.image_scale = 0.5;
  options_.mirror = false;
  run("encoder", 3);
  run("fine_tune", 1);
  run("denoiser", 300);
  const auto training =
      nlohmann::json::parse(core::readFile(folder_.path() / "model" / "training.json", "record"));
  EXPECT_EQ(training.at("data").at("samples"), 8);
  EXPECT_EQ(training.at("stages").at("denoiser").at("steps"), 300);
  EXPECT_EQ(training.at("stages").at("encoder").at("steps"), 3);
  // Predicting the mean alone costs 1 on the two state columns that vary, so 0.5, and the mean of
  // w_t / 12 = 0.26 on the steer; fitted samples cost far less.
  EXPECT_LT(training.at("stages").at("denoiser").at("loss").get<double>(), 0.2);
  EXPECT_LT(training.at("held_out").at("sample_ade_m").get<double>(), 0.5);
  const diffusion::Model model = diffusion::loadModel((folder_.path() / "model").string());
  EXPECT_EQ(model.spread.rows(), 8);
  EXPECT_GT(model.spread.minCoeff(), 0.0);
  EXPECT_TRUE(std::filesystem::exists(folder_.path() / "model" / "model_card.md"));
}

/// Sets a flag when a line with `text` is logged.
class StoppingBuffer : public std::stringbuf {
 public:
  StoppingBuffer(std::atomic<bool>& stop, std::string text) : stop_(stop), text_(std::move(text)) {}

 protected:
  int sync() override {
    if (str().find(text_) != std::string::npos) stop_ = true;
    return 0;
  }

 private:
  std::atomic<bool>& stop_;
  std::string text_;
};

TEST_F(TrainerTest, ResumedEncoderEqualsAnUninterruptedOneToTheBit) {
  run("encoder", 4);
  const std::filesystem::path path = folder_.path() / "model" / "encoder.checkpoint";
  const Checkpoint expected = readCheckpoint(path);
  StoppingBuffer buffer(stop_, "encoder step 2/4");
  std::ostream log(&buffer);
  options_.stage = "encoder";
  options_.overwrite = true;
  EXPECT_THROW(train(options_, stop_, log), core::Interrupted);
  EXPECT_EQ(readCheckpoint(path).facts.at("steps"), 2);
  stop_ = false;
  options_.overwrite = false;
  options_.resume = true;
  run("encoder", 4);
  const Checkpoint found = readCheckpoint(path);
  ASSERT_EQ(found.tensors.size(), expected.tensors.size());
  for (const auto& [name, tensor] : expected.tensors)
    EXPECT_TRUE(at::equal(found.tensors.at(name), tensor)) << name;
}

TEST_F(TrainerTest, AnInitialModelBringsItsNormalizerAndMustFit) {
  run("encoder", 1);
  run("denoiser", 1);
  const diffusion::Normalizer expected = diffusion::loadModel(options_.output).normalizer;
  test::writeShard(folder_.path() / "data" / "b.shard", 4);  // other data, another fit
  options_.init = options_.output;
  options_.output = (folder_.path() / "second").string();
  run("denoiser", 1);
  EXPECT_EQ(diffusion::loadModel(options_.output).normalizer.mean, expected.mean);
  EXPECT_EQ(diffusion::loadModel(options_.output).normalizer.scale, expected.scale);
  options_.architecture.state_hidden += 1;
  options_.overwrite = true;
  try {
    run("denoiser", 1);
    FAIL() << "trained";
  } catch (const core::InputError& error) {
    EXPECT_NE(std::string(error.what()).find("the architecture of '" + options_.init),
              std::string::npos)
        << error.what();
  }
}

TEST_F(TrainerTest, FineTuneLeavesAModelWithTheDenoiserOfTheInitialOne) {
  run("encoder", 1);
  EXPECT_NE(log_.str().find("no model is written yet: train stage denoiser"), std::string::npos);
  EXPECT_THROW(diffusion::loadModel(options_.output), core::InputError);
  run("denoiser", 1);
  const diffusion::Model initial = diffusion::loadModel(options_.output);
  options_.init = options_.output;
  options_.output = (folder_.path() / "tuned").string();
  run("fine_tune", 2);
  const diffusion::Model tuned = diffusion::loadModel(options_.output);
  const auto sameValues = [](const auto& left, const auto& right) {
    return std::equal(
        left.begin(), left.end(), right.begin(), right.end(),
        [](const auto& a, const auto& b) { return a.second.values == b.second.values; });
  };
  EXPECT_TRUE(sameValues(tuned.denoiser, initial.denoiser));
  EXPECT_FALSE(sameValues(tuned.encoder, initial.encoder));
}

bool holds(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST_F(TrainerTest, AnEarlierTrainingIsReplacedOnlyWhenAsked) {
  run("encoder", 2);
  const std::string before = core::readFile(output("encoder.checkpoint"), "checkpoint");
  for (const char* stage : {"encoder", "all"}) {
    const std::string text = refusal(stage);
    EXPECT_TRUE(holds(text, "holds a training of stage 'encoder' (encoder.checkpoint)")) << text;
    EXPECT_TRUE(holds(text, "--resume") && holds(text, "--overwrite")) << text;
  }
  EXPECT_EQ(core::readFile(output("encoder.checkpoint"), "checkpoint"), before);
  options_.resume = options_.overwrite = true;
  EXPECT_TRUE(holds(refusal("encoder"), "resume and overwrite are both set"));
  options_.resume = false;
  run("encoder", 1);
  EXPECT_EQ(stepsOf("encoder"), 1);
}

TEST_F(TrainerTest, AStageThatIsReplacedLeavesTheOthersAndAllReplacesEach) {
  run("encoder", 1);
  run("fine_tune", 2);
  options_.overwrite = true;
  run("encoder", 3);
  EXPECT_EQ(stepsOf("encoder"), 3);
  EXPECT_EQ(stepsOf("fine_tune"), 2);
  run("all", 1);
  EXPECT_EQ(stepsOf("encoder"), 1);
  EXPECT_EQ(stepsOf("denoiser"), 1);
  // Else the denoiser would have been trained on the encoder of the earlier training.
  EXPECT_FALSE(std::filesystem::exists(output("fine_tune.checkpoint")));
}

TEST_F(TrainerTest, AModelWithoutCheckpointsIsNotReplacedUnasked) {
  std::filesystem::create_directories(options_.output);
  core::writeFileAtomically(output("encoder.safetensors"), "weights");
  EXPECT_TRUE(holds(refusal("encoder"), "holds a model (encoder.safetensors) without"));
  options_.overwrite = true;
  EXPECT_EQ(refusal("encoder"), "trained");
}

TEST_F(TrainerTest, ARefusedRunLeavesNoFolder) {
  EXPECT_TRUE(holds(refusal("denoiser"), "holds no checkpoint of an encoder; train stage"));
  EXPECT_FALSE(std::filesystem::exists(options_.output));
}

TEST_F(TrainerTest, ExportNeedsADenoiser) {
  run("encoder", 1);
  EXPECT_TRUE(holds(refusal("export"), "holds no checkpoint of a denoiser; train stage"));
  EXPECT_FALSE(std::filesystem::exists(output("denoiser.safetensors")));
}

TEST_F(TrainerTest, OptionsOutOfRangeAreNamed) {
  options_.image_scale = 0.7;
  EXPECT_TRUE(holds(refusal("encoder"), "image_scale is 0.7; expected 1 or 0.5"));
  options_.image_scale = 1.0;
  options_.threads = 0;
  EXPECT_TRUE(holds(refusal("encoder"), "key 'threads' is '0'; expected a whole number in [1, "));
}

TEST_F(TrainerTest, SaysWhatIsMissing) {
  EXPECT_THROW(run("denoiser", 1), core::InputError);
  EXPECT_THROW(run("export", 1), core::InputError);
  EXPECT_THROW(run("decoder", 1), core::InputError);
  options_.data = folder_.path() / "nothing";
  EXPECT_THROW(run("encoder", 1), core::InputError);
}

}  // namespace
}  // namespace cdiff::training
