// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "learning/task.h"
#include "planners/weight_files.h"

namespace cdiff::planners {

/// What a NetworkTask trains, and its names.
template <class Architecture>
struct NetworkTaskTexts {
  WeightKind kind;
  std::string title;  ///< of the model card
  std::string stage;
  std::int64_t batch;  ///< where the options give none
  std::vector<inference::TensorShape> (*tensors)(const Architecture&);
  learning::SampleSchema (*fields)();  ///< of the samples made from scenes
};

/// The training of a planner whose weights are one network, which learns from samples of scenes in
/// one stage. `Settings` hold the `architecture` of the network and all that is chosen, and are
/// stored with the model; `State` holds what a run works on, its network as `net`.
template <class Settings, class State>
class NetworkTask : public learning::OneStageTask {
 public:
  std::vector<std::string> weightFiles() const override { return {texts_.kind.file}; }
  learning::SampleSchema sceneFields() const override { return texts_.fields(); }
  void describe(core::OptionsVisitor& visitor) override { settings.describe(visitor); }
  void validate() const override { settings.architecture.validate(); }
  nlohmann::json facts() const override {
    return {{"architecture", core::dumpOptions(settings.architecture)}};
  }
  std::vector<learning::TrainedPart> parts() override { return {{kPart, &parameters()}}; }

  learning::TrainedModel finish() override {
    learning::TrainedModel model;
    model.files = {{texts_.kind.file,
                    {networkMetadata(texts_.kind, settings.architecture), parameters().values()},
                    true,
                    ""}};
    model.held_out = makeStage(texts_.stage)->measureHeldOut();
    model.settings = {{"architecture", core::dumpOptions(settings.architecture)},
                      {"settings", core::dumpOptions(settings)}};
    model.title = texts_.title;
    model.measures = table(model.held_out);
    return model;
  }

  Settings settings;

  static constexpr const char* kPart = "network";  ///< name of its weights in checkpoints

 protected:
  using Architecture = decltype(Settings::architecture);

  explicit NetworkTask(const NetworkTaskTexts<Architecture>& texts)
      : OneStageTask(texts.stage, texts.batch, {{kPart, "a network"}}), texts_(texts) {}

  /// Ends `start`: the weights of the initial model where there is one, on the run's device.
  void loadWeights(const learning::TrainingRun& run) {
    const std::string& init = run.options.init;
    if (!init.empty())
      parameters().load(readNetwork(texts_.kind, init, texts_.tensors).weights, init);
    parameters().moveTo(run.device);
  }
  /// Measures in the model card, Markdown.
  virtual std::string table(const learning::Measures& held_out) const = 0;

  std::unique_ptr<State> state_;  ///< made by `start`

 private:
  learning::ParameterSet& parameters() { return state_->net.parameters(); }

  NetworkTaskTexts<Architecture> texts_;
};

}  // namespace cdiff::planners
