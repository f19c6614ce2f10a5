// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <string>

#include "e2e_cdiff/core/exceptions.h"
#include "learning/small_samples.h"
#include "learning/training_folder.h"
#include "planners/diffusion/training/prepared_data.h"

namespace cdiff::planners {
namespace {

/// A data set of eight small samples and checkpoints that hold a normalizer alone.
class StoredNormalizerTest : public testing::Test {
 protected:
  StoredNormalizerTest() {
    std::filesystem::create_directories(folder_.path() / "data");
    test::writeShard(folder_.path() / "data" / "a.shard", 8);
    options_.output = (folder_.path() / "model").string();
    std::filesystem::create_directories(options_.output);
    stored_.emplace(folder_.path() / "data", 0.0);
    dataset_.emplace(*stored_);
    initial_.normalizer = constant(9.0);
  }
  static diffusion::Normalizer constant(double mean) {
    const auto rows = static_cast<Eigen::Index>(test::smallSchema().horizon);
    return {traffic::Rollout::Constant(rows, traffic::kRolloutColumns, mean),
            traffic::Rollout::Constant(rows, traffic::kRolloutColumns, 2.0)};
  }
  void writeFacts(const std::string& stage, const nlohmann::json& facts) {
    learning::writeCheckpoint(learning::checkpointPath(options_.output, stage), {facts, {}});
  }
  void write(const std::string& stage, double mean) {
    writeFacts(stage, {{"normalizer", constant(mean).toJson()}});
  }
  /// First mean of the normalizer chosen for a stage.
  double chosen(const std::string& stage, bool resume, bool init = false) {
    options_.stage = stage;
    options_.resume = resume;
    return chooseNormalizer(options_, true, *dataset_, init ? &initial_ : nullptr).mean(0, 0);
  }
  double fitted() const { return fitNormalizer(*dataset_, true).mean(0, 0); }

  test::TemporaryFolder folder_;
  learning::TrainingOptions options_;
  std::optional<learning::Dataset> stored_;
  std::optional<learning::DrivingDataset> dataset_;
  diffusion::Model initial_;
};

TEST_F(StoredNormalizerTest, AFreshRunFitsOrTakesTheInitialModels) {
  for (const char* stage : {"all", "encoder", "fine_tune", "denoiser", "joint"}) {
    EXPECT_EQ(chosen(stage, false), fitted()) << stage;
    EXPECT_EQ(chosen(stage, true), fitted()) << stage;
    EXPECT_EQ(chosen(stage, true, true), 9.0) << stage;
  }
}

TEST_F(StoredNormalizerTest, ARunThatGoesOnTakesTheCheckpoints) {
  write("encoder", 1.0);
  write("denoiser", 3.0);
  EXPECT_EQ(chosen("encoder", true, true), 1.0);
  EXPECT_EQ(chosen("encoder", false, true), 9.0);
  EXPECT_EQ(chosen("denoiser", true, true), 3.0);
  EXPECT_EQ(chosen("denoiser", false), fitted());
  EXPECT_EQ(chosen("all", true), 1.0) << "that of the stage which is resumed first";
}

TEST_F(StoredNormalizerTest, AStageTakesThatOfTheStageItStartsFrom) {
  write("encoder", 1.0);
  EXPECT_EQ(chosen("fine_tune", false, true), 1.0);
  write("denoiser", 3.0);
  // It would be exported with the fine-tuned encoder.
  EXPECT_THROW(chosen("fine_tune", false, true), core::InputError);
  EXPECT_EQ(chosen("joint", false, true), 3.0);
  EXPECT_EQ(chosen("export", false, true), 3.0);
  write("joint", 4.0);
  EXPECT_EQ(chosen("export", false, true), 4.0);
  EXPECT_EQ(chosen("joint", true), 4.0);
}

TEST_F(StoredNormalizerTest, NumbersComeBackToTheBit) {
  const diffusion::Normalizer expected = fitNormalizer(*dataset_, true);
  writeFacts("denoiser", {{"normalizer", expected.toJson()}});
  options_.stage = "denoiser";
  options_.resume = true;
  const diffusion::Normalizer found = chooseNormalizer(options_, true, *dataset_, &initial_);
  EXPECT_EQ(found.mean, expected.mean);
  EXPECT_EQ(found.scale, expected.scale);
}

TEST_F(StoredNormalizerTest, ACheckpointWithoutOneWasFittedAndAMalformedOneIsNamed) {
  writeFacts("denoiser", {{"steps", 1}});
  EXPECT_EQ(chosen("denoiser", true, true), fitted());
  const nlohmann::json malformed[] = {"{\"mean\":[[1]]}", {{"mean", {{1.0}}}}};
  for (const nlohmann::json& normalizer : malformed) {
    writeFacts("denoiser", {{"normalizer", normalizer}});
    try {
      chosen("denoiser", true);
      FAIL() << "taken";
    } catch (const core::InputError& error) {
      EXPECT_NE(std::string(error.what()).find("denoiser.checkpoint': normalizer"),
                std::string::npos)
          << error.what();
    }
  }
}

}  // namespace
}  // namespace cdiff::planners
