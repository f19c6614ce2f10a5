// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <sstream>

#include "core/file.h"
#include "e2e_cdiff/core/exceptions.h"
#include "learning/small_samples.h"
#include "learning/stage_runner.h"
#include "learning/training_folder.h"

namespace cdiff::learning {
namespace {

using core::InputError;

/// One weight of three values is drawn toward targets that differ from step to step.
class ToyStage : public Stage {
 public:
  ToyStage() : parameters_(core::RandomStream(5, "toy")) {
    parameters_.declare("weight", {1, 3}, {Start::Kind::kUniform, 1.0});
  }
  const std::string& name() const override { return name_; }
  std::vector<TrainedPart> parts() override { return {{"toy", &parameters_}}; }
  std::int64_t batchSize() const override { return 2; }
  std::vector<std::size_t> samplesOf(std::int64_t step) override {
    return {static_cast<std::size_t>(2 * step), static_cast<std::size_t>(2 * step + 1)};
  }
  Loss loss(std::int64_t step) override {
    const auto target = static_cast<float>(std::sin(static_cast<double>(step)));
    const float factor = step == fail_at ? std::numeric_limits<float>::quiet_NaN() : 1.0F;
    if (step == stop_at && stop != nullptr) *stop = true;
    const at::Tensor loss = (parameters_("weight") - 3.0 - target).pow(2).mean() * factor;
    return {loss, {{"toy", loss}}};
  }
  StageRules rules() const override { return stage_rules; }
  Measures news() override { return news_now; }
  Measures measureHeldOut() override {
    return {{"distance", std::abs(parameters_("weight").mean().item<double>() - 3.0)}};
  }
  std::vector<float> weight() const { return toVector(parameters_("weight")); }

  std::int64_t fail_at = -1;
  std::int64_t stop_at = -1;
  std::atomic<bool>* stop = nullptr;
  StageRules stage_rules;
  Measures news_now;

 private:
  std::string name_ = "toy";
  ParameterSet parameters_;
};

class StageRunnerTest : public testing::Test {
 protected:
  StageRunnerTest() {
    options_.output = folder_.path().string();
    options_.steps = 40;
    options_.warm_up = 5;
    options_.learning_rate = 0.1;
    options_.validation_every = 10;
  }
  StageResult run(ToyStage& stage, const std::string& data = "data") {
    return StageRunner(stage, options_, {{"data", data}, {"share", share_}}, stop_, log_).run();
  }
  Checkpoint stored() const { return readCheckpoint(checkpointPath(options_.output, "toy")); }

  test::TemporaryFolder folder_;
  TrainingOptions options_;
  double share_ = 1.0;  ///< a fact that the task adds
  std::atomic<bool> stop_{false};
  std::ostringstream log_;
};

TEST_F(StageRunnerTest, LearnsAndLeavesTheAverage) {
  ToyStage stage;
  const StageResult result = run(stage);
  EXPECT_EQ(result.steps, 40);
  ToyStage untrained;
  EXPECT_LT(result.held_out.at("distance"), 0.7 * untrained.measureHeldOut().at("distance"));
  EXPECT_EQ(toVector(stored().tensors.at("average/toy/weight")), stage.weight());
  EXPECT_NE(toVector(stored().tensors.at("weight/toy/weight")), stage.weight());
}

TEST_F(StageRunnerTest, ResumedRunEqualsAnUninterruptedOneToTheBit) {
  ToyStage whole;
  run(whole);
  const Checkpoint expected = stored();
  ToyStage first;
  first.stop_at = 16;
  first.stop = &stop_;
  EXPECT_THROW(run(first), core::Interrupted);
  EXPECT_EQ(stored().facts.at("steps"), 17);
  stop_ = false;
  options_.resume = true;
  ToyStage second;
  run(second);
  EXPECT_EQ(second.weight(), whole.weight());
  const Checkpoint found = stored();
  ASSERT_EQ(found.tensors.size(), 4U);
  for (const auto& [name, tensor] : expected.tensors)
    EXPECT_TRUE(at::equal(found.tensors.at(name), tensor)) << name;
  EXPECT_EQ(found.facts.at("loss"), expected.facts.at("loss"));
}

// Asked to stop at step 17 of periods of 8, it goes on to 24; 40 steps are five periods, 42 would
// be rounded up to 48.
TEST_F(StageRunnerTest, StopsAndEndsBetweenPeriods) {
  options_.checkpoint_every = 0.0;
  ToyStage first;
  first.stage_rules.period = 8;
  first.stop_at = 16;
  first.stop = &stop_;
  EXPECT_THROW(run(first), core::Interrupted);
  EXPECT_EQ(stored().facts.at("steps"), 24);
  stop_ = false;
  options_.resume = true;
  options_.steps = 42;
  ToyStage second;
  second.stage_rules.period = 8;
  EXPECT_EQ(run(second).steps, 48);
}

// At step 10 of 40, after a warm-up, 30/40 of the rate are left; along the cosine 0.5 (1 + cos(pi /
// 4)) = 0.854.
TEST_F(StageRunnerTest, LearningRateFallsAsTheRulesHaveIt) {
  options_.warm_up = 0;
  options_.report_every = 0.0;
  for (const bool linear : {false, true}) {
    log_.str("");
    ToyStage stage;
    stage.stage_rules.linear = linear;
    options_.overwrite = true;
    run(stage);
    const std::string line = "toy step 10/40";
    const std::size_t begin = log_.str().find(line);
    ASSERT_NE(begin, std::string::npos);
    const std::string text = log_.str().substr(begin, log_.str().find('\n', begin) - begin);
    EXPECT_NE(text.find(linear ? "rate 75000.0e-6" : "rate 85355.3e-6"), std::string::npos) << text;
  }
}

// What a stage reports is a row at the step after it, so that a resumed run has it once.
TEST_F(StageRunnerTest, NewsOfAStageAreInTheCurves) {
  options_.steps = 2;
  ToyStage stage;
  stage.news_now = {{"return", 3.5}};
  run(stage);
  const std::string curves =
      core::readFile(std::filesystem::path(options_.output) / "curves.csv", "curves");
  EXPECT_EQ(curves.find("toy,0,"), std::string::npos);
  EXPECT_NE(curves.find(",return,3.5"), std::string::npos) << curves;
}

TEST_F(StageRunnerTest, CurvesOfAResumedRunHoldEveryStepOnce) {
  options_.validation_every = 10;
  ToyStage first;
  first.stop_at = 16;
  first.stop = &stop_;
  EXPECT_THROW(run(first), core::Interrupted);
  stop_ = false;
  options_.resume = true;
  ToyStage second;
  run(second);
  const std::string curves =
      core::readFile(std::filesystem::path(options_.output) / "curves.csv", "curves");
  for (const char* step : {"10", "20", "30", "40"}) {
    const std::string row = std::string("toy,") + step + ",";
    std::size_t rows = 0;
    for (std::size_t at = curves.find(row); at != std::string::npos; at = curves.find(row, at + 1))
      rows += curves.find("held_out_distance", at) < curves.find('\n', at) ? 1 : 0;
    EXPECT_EQ(rows, 1U) << step << "\n" << curves;
  }
}

TEST_F(StageRunnerTest, FinishedStageIsNotTrainedAgain) {
  ToyStage stage;
  run(stage);
  options_.resume = true;
  ToyStage again;
  again.fail_at = 0;
  EXPECT_EQ(run(again).steps, 40);
  EXPECT_EQ(again.weight(), stage.weight());
}

TEST_F(StageRunnerTest, StopsWhenTheLossIsNotANumber) {
  ToyStage stage;
  stage.fail_at = 7;
  std::string message;
  try {
    run(stage);
  } catch (const DivergedError& error) {
    message = error.what();
  }
  EXPECT_NE(message.find("at step 7"), std::string::npos) << message;
  EXPECT_NE(message.find("samples of its batch are 14 15"), std::string::npos) << message;
  EXPECT_EQ(stored().facts.at("steps"), 7);
  EXPECT_TRUE(at::isfinite(stored().tensors.at("weight/toy/weight")).all().item<bool>());
}

TEST_F(StageRunnerTest, RefusesToResumeAnotherRun) {
  ToyStage stage;
  run(stage);
  options_.resume = true;
  ToyStage other;
  EXPECT_THROW(run(other, "other data"), InputError);
  share_ = 0.5;
  EXPECT_THROW(run(other), InputError);
  share_ = 1.0;
  options_.seed = 2;
  EXPECT_THROW(run(other), InputError);
}

TEST_F(StageRunnerTest, RefusesToResumeWithAnotherNormalizer) {
  const auto runWith = [&](double mean) {
    ToyStage stage;
    const nlohmann::json facts = {{"data", "data"}, {"normalizer", {{"mean", mean}}}};
    StageRunner(stage, options_, facts, stop_, log_).run();
  };
  runWith(0.25);
  options_.resume = true;
  runWith(0.25);
  EXPECT_THROW(runWith(0.5), InputError);
}

TEST_F(StageRunnerTest, SaysWhatIsWrongWithACheckpoint) {
  ToyStage stage;
  run(stage);
  const auto path = checkpointPath(options_.output, "toy");
  std::string content = core::readFile(path, "checkpoint");
  content[content.size() / 2] ^= 1;
  core::writeFileAtomically(path, content);
  options_.resume = true;
  ToyStage again;
  EXPECT_THROW(run(again), InputError);
  core::writeFileAtomically(path, content.substr(0, 20));
  EXPECT_THROW(run(again), InputError);
}

TEST_F(StageRunnerTest, NamesThePathThatCannotBeWritten) {
  core::writeFileAtomically(folder_.path() / "curves.csv", "mine");
  options_.output = folder_.path().string();
  ToyStage stage;
  try {
    run(stage);
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("curves.csv"), std::string::npos);
  }
  EXPECT_EQ(core::readFile(folder_.path() / "curves.csv", "curves"), "mine");
}

TEST_F(StageRunnerTest, TimeLimitEndsTheStage) {
  options_.steps = 1000000000;
  options_.time_limit = 0.05;
  options_.anneal_by_time = true;
  ToyStage stage;
  const StageResult result = run(stage);
  EXPECT_GT(result.steps, 0);
  EXPECT_LT(result.steps, 1000000000);
  EXPECT_EQ(stored().facts.at("done"), true);
}

TEST_F(StageRunnerTest, ProgressIsAgainstWhatEndsTheStageFirst) {
  options_.report_every = 0.0;
  ToyStage by_steps;
  options_.time_limit = 3600.0;  // 40 steps take far less
  run(by_steps);
  EXPECT_NE(log_.str().find("toy step 40/40 loss"), std::string::npos) << log_.str();
  log_.str("");
  ToyStage by_time;
  options_.steps = 1000000000;
  options_.time_limit = 1.0;
  options_.report_every = 0.3;
  run(by_time);
  // At 0.3 s 30 % of the time is over, and far less than 1e9 steps.
  EXPECT_NE(log_.str().find(", 0:00:00 of 0:00:01 loss"), std::string::npos) << log_.str();
  EXPECT_EQ(log_.str().find("/1000000000"), std::string::npos) << log_.str();
}

}  // namespace
}  // namespace cdiff::learning
