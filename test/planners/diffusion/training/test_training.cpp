// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "core/output_folder.h"
#include "diffusion/model.h"
#include "learning/small_samples.h"
#include "learning/training_fixture.h"
#include "planners/diffusion/training/diffusion_task.h"

namespace cdiff::planners {
namespace {

/// Eight samples, small networks, every sample in every batch.
class DiffusionTrainingTest : public test::TrainingFixture {
 protected:
  DiffusionTrainingTest() : training_(trainingOf(diffusionTraining(), "model")) {
    test::writeShard(path("data") / "a.shard", 8);
    settings().architecture = test::smallArchitecture();
    training_.options.validation_share = 0.0;
    training_.options.batch = 8;
    training_.options.warm_up = 5;
    training_.options.learning_rate = 2e-3;
    training_.options.validation_every = 100000;
  }

  DiffusionTrainingSettings& settings() {
    return dynamic_cast<DiffusionTask&>(*training_.task).settings;
  }
  void run(const std::string& stage, std::int64_t steps) {
    training_.options.stage = stage;
    training_.options.steps = steps;
    train(training_);
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
    return std::filesystem::path(training_.options.output) / name;
  }
  std::int64_t stepsOf(const std::string& stage) const {
    return learning::readCheckpoint(output(stage + ".checkpoint")).facts.at("steps");
  }

  learning::Training training_;
};

TEST_F(DiffusionTrainingTest, AllStagesMakeAModelThatFitsEightSamples) {
  settings().image_scale = 0.5;
  settings().mirror = false;
  run("encoder", 3);
  run("fine_tune", 1);
  run("denoiser", 300);
  const nlohmann::json training = record("model");
  EXPECT_EQ(training.at("data").at("samples"), 8);
  EXPECT_EQ(training.at("stages").at("denoiser").at("steps"), 300);
  EXPECT_EQ(training.at("stages").at("encoder").at("steps"), 3);
  // Predicting the mean alone costs 1 on the two state columns that vary, so 0.5, and the mean of
  // w_t / 12 = 0.26 on the steer; fitted samples cost far less.
  EXPECT_LT(training.at("stages").at("denoiser").at("loss").get<double>(), 0.2);
  const auto held_out = [&](const std::string& figure) {
    return training.at("held_out").at(figure).get<double>();
  };
  EXPECT_LT(held_out("sample_ade_m"), 0.5);
  // The vehicles keep their speed; there are two of each maneuver.
  EXPECT_NEAR(held_out("constant_velocity_ade_m"), 0.0, 1e-5);
  EXPECT_NEAR(held_out("constant_velocity_speed_mps"), 0.0, 1e-5);
  EXPECT_FALSE(training.at("held_out").contains("constant_velocity_steer"));
  EXPECT_GT(held_out("least_of_8_ade_m"), 0.0);
  EXPECT_LT(held_out("least_of_8_ade_m"), held_out("sample_ade_m"));
  EXPECT_LE(held_out("least_of_8_ade_m"), held_out("least_of_8_fde_m"));
  double by_maneuver = 0.0;
  for (const std::string maneuver : {"straight", "left", "right", "other"}) {
    EXPECT_EQ(held_out("sample_" + maneuver + "_samples"), 2.0);
    by_maneuver += held_out("sample_" + maneuver + "_ade_m") / 4.0;
  }
  EXPECT_NEAR(by_maneuver, held_out("sample_ade_m"), 1e-6);
  const diffusion::Model model = diffusion::loadModel(path("model").string());
  EXPECT_EQ(model.spread.rows(), 8);
  EXPECT_GT(model.spread.minCoeff(), 0.0);
  EXPECT_TRUE(std::filesystem::exists(path("model") / "model_card.md"));
}

TEST_F(DiffusionTrainingTest, ResumedEncoderEqualsAnUninterruptedOneToTheBit) {
  run("encoder", 4);
  training_.options.output = path("resumed").string();
  training_.options.stage = "encoder";
  trainUntil(training_, "encoder step 2/4");
  EXPECT_EQ(stepsOf("encoder"), 2);
  training_.options.resume = true;
  run("encoder", 4);
  expectSameCheckpoints("model", "resumed", "encoder");
}

TEST_F(DiffusionTrainingTest, AnInitialModelBringsItsNormalizerAndMustFit) {
  run("encoder", 1);
  run("denoiser", 1);
  const diffusion::Normalizer expected = diffusion::loadModel(training_.options.output).normalizer;
  test::writeShard(path("data") / "b.shard", 4);  // other data, another fit
  training_.options.init = training_.options.output;
  training_.options.output = path("second").string();
  run("denoiser", 1);
  EXPECT_EQ(diffusion::loadModel(training_.options.output).normalizer.mean, expected.mean);
  EXPECT_EQ(diffusion::loadModel(training_.options.output).normalizer.scale, expected.scale);
  settings().architecture.state_hidden += 1;
  training_.options.overwrite = true;
  try {
    run("denoiser", 1);
    FAIL() << "trained";
  } catch (const core::InputError& error) {
    EXPECT_NE(std::string(error.what()).find("the architecture of '" + training_.options.init),
              std::string::npos)
        << error.what();
  }
}

TEST_F(DiffusionTrainingTest, ThePapersNetworkStartsFromTheEncoderOfAnother) {
  run("encoder", 1);
  run("denoiser", 1);
  const diffusion::Model other = diffusion::loadModel(training_.options.output);
  training_.options.init = training_.options.output;
  training_.options.output = path("paper").string();
  settings().network = "paper";
  settings().loss = "plain";
  for (const char* stage :
       {"fine_tune", "export", "all"})  // would keep a denoiser that is not there
    EXPECT_NE(refusal(stage).find("the architecture of '"), std::string::npos) << stage;
  run("denoiser", 2);
  const diffusion::Model model = diffusion::loadModel(training_.options.output);
  EXPECT_EQ(model.architecture, other.architecture.imageAlone());
  EXPECT_EQ(model.encoder.at("project.weight").values, other.encoder.at("project.weight").values);
  EXPECT_EQ(record("paper").at("network"), "paper");
  run("joint", 2);
  EXPECT_NE(diffusion::loadModel(training_.options.output).encoder.at("project.weight").values,
            other.encoder.at("project.weight").values);
  EXPECT_EQ(record("paper").at("stages").at("joint").at("steps"), 2);
  training_.options.init = training_.options.output;
  training_.options.output = path("back").string();
  settings().network = "default";
  EXPECT_NE(refusal("denoiser").find("the architecture of '"), std::string::npos);
}

TEST_F(DiffusionTrainingTest, MotionIsLearnedOnFromAModelWithoutIt) {
  run("encoder", 1);
  run("denoiser", 3);
  const diffusion::Model narrow = diffusion::loadModel(training_.options.output);
  training_.options.init = training_.options.output;
  training_.options.output = path("motion").string();
  settings().network = "motion";
  EXPECT_NE(refusal("denoiser").find("needs the field 'target_speed' of the samples"),
            std::string::npos);
  test::writeShard(path("data") / "a.shard", 8, test::motionSchema());
  EXPECT_NE(refusal("fine_tune").find("the architecture of '"), std::string::npos);
  training_.options.learning_rate = 1e-9;  // leaves the weights as they are
  run("denoiser", 1);
  const diffusion::Model wide = diffusion::loadModel(training_.options.output);
  EXPECT_EQ(wide.architecture, narrow.architecture.withMotion());
  const auto measure = [&](const std::string& name, const char* figure) {
    return record(name).at("held_out").at(figure).get<double>();
  };
  // What the wide one is given more than the narrow one changes nothing yet, but for the order in
  // which some processors add up rows of another length: 1e-6 m, where new weights of 0.001 in
  // place of 0 make 2e-5 m.
  EXPECT_FLOAT_EQ(measure("motion", "sample_one_image_ade_m"), measure("motion", "sample_ade_m"));
  EXPECT_NEAR(measure("motion", "sample_ade_m"), measure("model", "sample_ade_m"), 1e-5);
  training_.options.learning_rate = 2e-3;
  training_.options.overwrite = true;
  run("denoiser", 40);
  EXPECT_NE(measure("motion", "sample_ade_m"), measure("motion", "sample_one_image_ade_m"));
  EXPECT_NE(measure("motion", "sample_ade_m"), measure("motion", "sample_no_target_ade_m"));
  EXPECT_NE(measure("motion", "sample_no_route_ade_m"),
            measure("motion", "sample_image_alone_ade_m"));
  run("joint", 2);
  EXPECT_EQ(record("motion").at("network"), "motion");
}

TEST_F(DiffusionTrainingTest, FineTuneLeavesAModelWithTheDenoiserOfTheInitialOne) {
  run("encoder", 1);
  EXPECT_NE(log_.str().find("no model is written yet: train stage denoiser"), std::string::npos);
  EXPECT_THROW(diffusion::loadModel(training_.options.output), core::InputError);
  run("denoiser", 1);
  const diffusion::Model initial = diffusion::loadModel(training_.options.output);
  training_.options.init = training_.options.output;
  training_.options.output = path("tuned").string();
  run("fine_tune", 2);
  const diffusion::Model tuned = diffusion::loadModel(training_.options.output);
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

TEST_F(DiffusionTrainingTest, AnEarlierTrainingIsReplacedOnlyWhenAsked) {
  run("encoder", 2);
  const std::string before = core::readFile(output("encoder.checkpoint"), "checkpoint");
  for (const char* stage : {"encoder", "all"}) {
    const std::string text = refusal(stage);
    EXPECT_TRUE(holds(text, "holds a training of stage 'encoder' (encoder.checkpoint)")) << text;
    EXPECT_TRUE(holds(text, "--resume") && holds(text, "--overwrite")) << text;
  }
  EXPECT_EQ(core::readFile(output("encoder.checkpoint"), "checkpoint"), before);
  training_.options.resume = training_.options.overwrite = true;
  EXPECT_TRUE(holds(refusal("encoder"), "resume and overwrite are both set"));
  training_.options.resume = false;
  run("encoder", 1);
  EXPECT_EQ(stepsOf("encoder"), 1);
}

TEST_F(DiffusionTrainingTest, AStageThatIsReplacedLeavesTheOthersAndAllReplacesEach) {
  run("encoder", 1);
  run("fine_tune", 2);
  training_.options.overwrite = true;
  run("encoder", 3);
  EXPECT_EQ(stepsOf("encoder"), 3);
  EXPECT_EQ(stepsOf("fine_tune"), 2);
  run("all", 1);
  EXPECT_EQ(stepsOf("encoder"), 1);
  EXPECT_EQ(stepsOf("denoiser"), 1);
  // Else the denoiser would have been trained on the encoder of the earlier training.
  EXPECT_FALSE(std::filesystem::exists(output("fine_tune.checkpoint")));
}

TEST_F(DiffusionTrainingTest, AModelWithoutCheckpointsIsNotReplacedUnasked) {
  std::filesystem::create_directories(training_.options.output);
  core::writeFileAtomically(output("encoder.safetensors"), "mine");
  training_.options.overwrite = true;
  EXPECT_TRUE(holds(refusal("encoder"), "encoder.safetensors"));
  EXPECT_EQ(core::readFile(output("encoder.safetensors"), "weights"), "mine");
  std::filesystem::remove(output("encoder.safetensors"));
  core::writeOwnFile(output("encoder.safetensors"), "weights");
  training_.options.overwrite = false;
  EXPECT_TRUE(holds(refusal("encoder"), "holds a model (encoder.safetensors) without"));
  training_.options.overwrite = true;
  EXPECT_EQ(refusal("encoder"), "trained");
}

TEST_F(DiffusionTrainingTest, ARefusedRunLeavesNoFolder) {
  EXPECT_TRUE(holds(refusal("denoiser"), "holds no checkpoint of an encoder; train stage"));
  EXPECT_FALSE(std::filesystem::exists(training_.options.output));
}

TEST_F(DiffusionTrainingTest, ExportNeedsADenoiser) {
  run("encoder", 1);
  EXPECT_TRUE(holds(refusal("export"), "holds no checkpoint of a denoiser; train stage"));
  EXPECT_FALSE(std::filesystem::exists(output("denoiser.safetensors")));
}

TEST_F(DiffusionTrainingTest, OptionsOutOfRangeAreNamed) {
  settings().image_scale = 0.7;
  EXPECT_TRUE(holds(refusal("encoder"), "image_scale is 0.7; expected 1 or 0.5"));
  settings().image_scale = 1.0;
  training_.options.threads = 0;
  EXPECT_TRUE(holds(refusal("encoder"), "key 'threads' is '0'; expected a whole number in [1, "));
}

TEST_F(DiffusionTrainingTest, SaysWhatIsMissing) {
  EXPECT_THROW(run("denoiser", 1), core::InputError);
  EXPECT_THROW(run("export", 1), core::InputError);
  EXPECT_THROW(run("decoder", 1), core::InputError);
  training_.options.data = path("nothing").string();
  EXPECT_THROW(run("encoder", 1), core::InputError);
}

}  // namespace
}  // namespace cdiff::planners
