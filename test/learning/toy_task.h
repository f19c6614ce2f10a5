// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// A task that no planner has, as a planner's own would be: linear regression on two stored fields,
/// target = 2 input_0 - 3 input_1 + 1.
#pragma once

#include <atomic>
#include <optional>

#include "learning/batches.h"
#include "learning/layers.h"
#include "learning/samples/dataset.h"
#include "learning/task.h"
#include "learning/task_registry.h"

namespace cdiff::test {

/// `count` samples of sessions 0 to 4; the inputs are drawn from [-1, 1].
inline void writeToyShard(const std::filesystem::path& path, std::size_t count) {
  using learning::FieldType;
  learning::ShardWriter writer({{{learning::kSessionField, FieldType::kU64},
                                 {"inputs", FieldType::kF32, {2}},
                                 {"target", FieldType::kF32, {1}}}});
  const core::RandomStream random(11, "toy inputs");
  for (std::size_t i = 0; i < count; ++i) {
    const auto a = static_cast<float>(random.uniform({i}, 0, -1.0, 1.0));
    const auto b = static_cast<float>(random.uniform({i}, 1, -1.0, 1.0));
    writer.append({{{learning::kSessionField, std::vector<std::uint64_t>{i % 5}},
                    {"inputs", std::vector<float>{a, b}},
                    {"target", std::vector<float>{2.0F * a - 3.0F * b + 1.0F}}}});
  }
  writer.write(path);
}

/// The linear map, and squared errors of it.
class ToyStage : public learning::EvenStage {
 public:
  ToyStage(const learning::TrainingRun& run, learning::ParameterSet& weights)
      : EvenStage(run, "fit", {"line", &weights}, 8, "fit order"), run_(run), weights_(weights) {}

  learning::Loss loss(std::int64_t step) override {
    const at::Tensor error = squaredError(samplesOf(step));
    return {error, {{"square", error}}};
  }
  learning::Measures measureHeldOut() override {
    const at::NoGradGuard no_gradient;
    return {{"square", squaredError(run_.held_out).item<double>()}};
  }

 private:
  at::Tensor squaredError(const std::vector<std::size_t>& samples) const {
    const auto field = [&](const char* name) {
      return learning::fieldBatch(run_.dataset, samples, name, run_.device).values;
    };
    return (learning::linear(weights_, "line", field("inputs")) - field("target")).pow(2).mean();
  }

  const learning::TrainingRun& run_;
  learning::ParameterSet& weights_;
};

class ToyTask : public learning::OneStageTask {
 public:
  ToyTask() : OneStageTask("fit", 8, {{"line", "a line"}}) {}
  std::vector<std::string> weightFiles() const override { return {"line.safetensors"}; }
  std::vector<std::string> fields() const override { return needed; }
  void describe(core::OptionsVisitor& visitor) override {
    visitor.number({"slope", "", "Bound of the first weights."}, slope, 0.0, 10.0);
  }

  void start(const learning::TrainingRun& run) override {
    run_ = &run;
    weights_.emplace(run.stream("line"));
    weights_->declare("line.weight", {1, 2}, {learning::Start::Kind::kUniform, slope});
    weights_->declare("line.bias", {1}, {});
  }
  nlohmann::json facts() const override { return {{"slope", slope}}; }
  std::vector<learning::TrainedPart> parts() override { return {{"line", &*weights_}}; }
  std::unique_ptr<learning::Stage> makeStage(const std::string&) override {
    return std::make_unique<ToyStage>(*run_, *weights_);
  }
  learning::TrainedModel finish() override {
    learning::TrainedModel model;
    model.files = {{"line.safetensors", {{{"format", "toy"}}, weights_->values()}, true, ""}};
    model.held_out = ToyStage(*run_, *weights_).measureHeldOut();
    model.settings = {{"slope", slope}};
    model.title = "A line";
    model.measures = "Squared error.\n";
    return model;
  }

  double slope = 1.0;
  std::vector<std::string> needed = {"inputs", "target"};

 private:
  const learning::TrainingRun* run_ = nullptr;
  std::optional<learning::ParameterSet> weights_;
};

inline learning::TaskDescriptor toyTraining() {
  return {"toy", "Fit a line",
          []() -> std::shared_ptr<learning::Task> { return std::make_shared<ToyTask>(); }};
}

}  // namespace cdiff::test
