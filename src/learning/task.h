// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <ATen/ATen.h>

#include <atomic>
#include <cstdint>
#include <iosfwd>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "e2e_cdiff/core/options.h"
#include "inference/safetensors.h"
#include "learning/curve_log.h"
#include "learning/parameters.h"
#include "learning/samples/dataset.h"
#include "learning/samples/sample_order.h"
#include "learning/samples/scene.h"
#include "learning/training_options.h"

namespace cdiff::learning {

/// A loss with its parts, for the log.
struct Loss {
  at::Tensor total;
  std::vector<std::pair<std::string, at::Tensor>> terms;

  /// Adds a part to the total, and to what is logged under its name.
  void add(const std::string& name, const at::Tensor& term);
};

/// How the steps of a stage are made where it is not as usual.
struct StageRules {
  double epsilon = 1e-8;    ///< of AdamW, added to the root of the second moment
  bool linear = false;      ///< the learning rate falls linearly to 0, not along a cosine
  bool clip_apart = false;  ///< the gradient of each part is clipped by its own norm
  std::int64_t period = 1;  ///< steps that belong together: a stage ends, stops and leaves
                            ///< checkpoints at multiples of it only
};

/// Weights that a stage trains; their names in checkpoints start with `name`.
struct TrainedPart {
  std::string name;
  ParameterSet* parameters;
};

/// A stage of training: which weights it trains by which loss, and how held-out samples judge it.
class Stage {
 public:
  virtual ~Stage() = default;
  virtual const std::string& name() const = 0;
  virtual std::vector<TrainedPart> parts() = 0;
  virtual std::int64_t batchSize() const = 0;
  /// The loss on the batch of a step, which is a function of seed, stage and step alone: so a
  /// resumed run goes on as if it had never stopped.
  virtual Loss loss(std::int64_t step) = 0;
  virtual StageRules rules() const { return {}; }
  /// What the last call of `loss` found out besides, for the curves; empty when nothing.
  virtual Measures news() { return {}; }
  /// Samples of a step, for messages.
  virtual std::vector<std::size_t> samplesOf(std::int64_t step) = 0;
  /// Measures on held-out samples.
  virtual Measures measureHeldOut() = 0;
  /// The learning rate of a step where the stage has a course of its own; nullopt: warm-up and
  /// cosine of the options.
  virtual std::optional<double> learningRate(std::int64_t) const { return std::nullopt; }
};

/// Which checkpoints give a part of the weights.
struct PartSource {
  std::string part;                 ///< TrainedPart::name
  std::string what;                 ///< for messages, "an encoder"
  std::vector<std::string> stages;  ///< whose checkpoints hold it, the best first
  std::string first;  ///< stage to train first where none is there; empty: the part starts over
};

/// What is known about a stage before it runs: its name, the parts it starts with, and what it
/// leaves.
struct StageInfo {
  std::string name;
  std::vector<PartSource> starts;  ///< what the stage starts with
  bool makes_model = true;         ///< false: it leaves a checkpoint only
  std::vector<PartSource> rest;    ///< of the model, what the stage neither trains nor starts with
  std::string next;                ///< what to do next where no model is written
};

/// A run of the trainer, as its task sees it.
struct TrainingRun {
  const Dataset& dataset;
  const TrainingOptions& options;
  at::Device device;
  std::vector<std::size_t> held_out;  ///< validation samples that judge
  const std::atomic<bool>& stop;
  std::ostream& log;

  /// Samples a step: as the options say, or `usual`.
  std::int64_t batchSize(std::int64_t usual) const {
    return options.batch > 0 ? options.batch : usual;
  }
  core::RandomStream stream(const std::string& name) const {
    return core::RandomStream(static_cast<std::uint64_t>(options.seed), name);
  }
};

/// A stage of one part, for which every training sample comes as often as any other.
class EvenStage : public Stage {
 public:
  const std::string& name() const override { return name_; }
  std::vector<TrainedPart> parts() override { return {part_}; }
  std::int64_t batchSize() const override { return batch_; }
  std::vector<std::size_t> samplesOf(std::int64_t step) override { return order_.at(step); }

 protected:
  /// `batch` where the options give none; the order is drawn from the stream `order`.
  EvenStage(const TrainingRun& run, const std::string& name, const TrainedPart& part,
            std::int64_t batch, const std::string& order);

 private:
  std::string name_;
  TrainedPart part_;
  std::int64_t batch_;
  SampleOrder order_;
};

/// A file of the trained model.
struct WeightFile {
  std::string name;  ///< in the output folder
  inference::SafetensorsFile content;
  bool has_record = true;  ///< metadata "training" holds the record of the training
  std::string hash_key;    ///< metadata key by which later files name this one's hash; empty: none
};

/// What a task leaves behind.
struct TrainedModel {
  std::vector<WeightFile> files;  ///< written as F16
  Measures held_out;
  nlohmann::json settings = nlohmann::json::object();  ///< settings of the task, for the record
  std::string title;                                   ///< title of the model card
  std::string trained_on;  ///< what it learned from, for the model card; empty: the data set
  std::string measures;    ///< measures in the model card, Markdown
};

/// Texts of the task in `cdiff train --help`.
struct TaskTexts {
  std::string all;    ///< the stages that `all` trains
  std::string batch;  ///< samples a step where none are given
};

/// What there is to learn: the interface between this library, which runs stages, and a planner's
/// training, which knows its samples, networks and losses.
class Task {
 public:
  virtual ~Task() = default;

  virtual TaskTexts texts() const = 0;
  /// In the order in which they are trained; `export` and `all` are not names of stages.
  virtual std::vector<StageInfo> stages() const = 0;
  /// Names of the stages that `all` trains under the task's options.
  virtual std::vector<std::string> allStages() const = 0;
  /// Every part of the model, for `export`.
  virtual std::vector<PartSource> model() const = 0;
  /// Names of the weight files in the output folder, and of what else the task keeps there.
  virtual std::vector<std::string> weightFiles() const = 0;
  virtual std::vector<std::string> otherFiles() const { return {}; }
  /// False for a task that makes its samples itself: it takes no data folder, and the data set of
  /// its run is empty.
  virtual bool needsSamples() const { return true; }
  /// Names of the fields that it needs of each sample.
  virtual std::vector<std::string> fields() const = 0;
  /// The fields of the samples that the task makes of scenes; without any it learns from shards.
  /// One must be kSessionField, which the trainer sets to a hash of the scene's network file: whole
  /// networks are held out.
  virtual SampleSchema sceneFields() const { return {}; }
  /// The samples of a scene, called scene after scene before `start`.
  virtual std::vector<Sample> samplesOf(const Scene&) { return {}; }

  /// Sets the options of every training whose default is another for this task.
  virtual void setDefaults(TrainingOptions&) const {}
  /// The task's own options; `validate` throws InputError naming the key.
  virtual void describe(core::OptionsVisitor&) {}
  virtual void validate() const {}

  /// Makes the networks, with the weights of the initial model where the options name one; before
  /// all that follows, whose calls `run` outlives. Throws InputError.
  virtual void start(const TrainingRun& run) = 0;
  /// What goes into every checkpoint, and must be the same in one that is resumed.
  virtual nlohmann::json facts() const = 0;
  virtual std::vector<TrainedPart> parts() = 0;
  /// A stage, once the parts that it starts with are loaded.
  virtual std::unique_ptr<Stage> makeStage(const std::string& name) = 0;
  virtual TrainedModel finish() = 0;
};

/// A task of one stage, which trains all parts of the model, on every field of the samples that it
/// makes of scenes.
class OneStageTask : public Task {
 public:
  TaskTexts texts() const override { return {stage_, std::to_string(batch_)}; }
  std::vector<StageInfo> stages() const override { return {{stage_, {}, true, {}, ""}}; }
  std::vector<std::string> allStages() const override { return {stage_}; }
  std::vector<PartSource> model() const override;
  std::vector<std::string> fields() const override;

 protected:
  /// `parts`: their names, and what they are for messages, {"network", "a network"}.
  OneStageTask(const std::string& stage, std::int64_t batch,
               const std::vector<std::pair<std::string, std::string>>& parts)
      : stage_(stage), batch_(batch), parts_(parts) {}

 private:
  std::string stage_;
  std::int64_t batch_;
  std::vector<std::pair<std::string, std::string>> parts_;
};

}  // namespace cdiff::learning
