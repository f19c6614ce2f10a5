// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/rift/training/rift_task.h"

#include <filesystem>

#include "e2e_cdiff/core/exceptions.h"
#include "planners/rift/training/rift_stage.h"

namespace cdiff::planners {
namespace {

std::filesystem::path startingFolder(const std::string& init) {
  return WeightOptions{init}.folder();
}

/// Of Pluto, or of an earlier fine-tuning where there is one.
const WeightKind& startingKind(const std::string& init) {
  return std::filesystem::exists(startingFolder(init) / kRift.file) ? kRift : kPluto;
}

learning::ParameterSet headOf(const PlutoModel& model) {
  learning::ParameterSet head(core::RandomStream(0, "rift head"));
  std::map<std::string, inference::Tensor> values;
  for (const auto& [name, tensor] : model.weights) {
    if (!ofScoreHead(name)) continue;
    head.declare(name, tensor.shape, {});
    values[name] = tensor;
  }
  head.load(values, "score head");
  return head;
}

}  // namespace

void RiftTrainingSettings::describe(core::OptionsVisitor& visitor) {
  samples.describe(visitor);
  visitor.text({"objective", "", "RIFT's, or GRPO's: no dual clip, but a divergence."}, objective,
               {"rift", "grpo"});
  visitor.number({"kl_weight", "", "Weight of the divergence from Pluto in grpo."}, kl_weight, 0.0,
                 100.0);
  visitor.integer({"buffer", "", "States gathered at a time."}, buffer, 1, 1 << 20);
  visitor.integer({"epochs", "", "Passes over the states of a buffer."}, epochs, 1, 1000);
  visitor.text({"tracker", "", "Drives the candidates: that with which the planner is to drive."},
               tracker, {planning::kTunedTracker, planning::kPublishedTracker});
}

RiftObjective RiftTrainingSettings::objectiveOf() const {
  RiftObjective made;
  if (objective == "rift") return made;
  made.dual_clip = 0.0;
  made.divergence = kl_weight;
  return made;
}

RiftTask::RiftTask() : OneStageTask(kRiftStage, kRiftBatch, {{"head", "a score head"}}) {}

/// The scenes' moments; what networks make of them waits until the weights are known.
std::vector<learning::Sample> RiftTask::samplesOf(const learning::Scene& scene) {
  if (!worlds_) worlds_.emplace(PlutoArchitecture{});
  const auto number = static_cast<std::uint32_t>(scenes_.size());
  scenes_.emplace_back(scene, worlds_->of(scene));
  std::vector<learning::Sample> samples;
  for (RiftMoment& moment : riftMoments(scene, scenes_.back(), number, settings.samples)) {
    samples.push_back(toSample(moment.place, scenes_.back()));
    moments_.push_back(std::move(moment));
  }
  return samples;
}

void RiftTask::setDefaults(learning::TrainingOptions& options) const {
  constexpr std::int64_t kBuffers = 10;
  options.init = "pluto";
  options.steps = kBuffers * settings.epochs * settings.buffer / kRiftBatch;
  options.learning_rate = 1e-4;
  options.weight_decay = 1e-5;
  options.clip = 0.5;
  options.average_decay = 0.0;
  options.checkpoint_every = 0.0;  // after every buffer
  options.validation_samples = 1000;
}

void RiftTask::start(const learning::TrainingRun& run) {
  if (run.options.init.empty())
    throw core::InputError("task 'rift' fine-tunes weights of 'pluto'; --init must name them");
  const std::filesystem::path folder = startingFolder(run.options.init);
  const WeightKind& kind = startingKind(run.options.init);
  const PlutoModel model = readPlutoModel(kind, folder);
  learning::ParameterSet head = headOf(model);
  head.moveTo(run.device);
  const dynamics::BicycleModelOptions vehicle;
  state_.reset(new RiftTrainingState{
      run, settings, model, weightSha256(kind, folder), std::move(head),
      RiftGroups(model, vehicle, planning::PlanTrackerOptions::named(settings.tracker)), scenes_,
      moments_});
  const std::int64_t each = RiftStage(*state_).stepsOfBuffer();
  if (run.options.steps % each != 0) {
    throw core::InputError("steps is " + std::to_string(run.options.steps) + "; a multiple of " +
                           std::to_string(each) + ", the steps of a buffer, was expected");
  }
}

nlohmann::json RiftTask::facts() const {
  return {{"start", state_->start}, {"settings", core::dumpOptions(settings)}};
}

std::vector<learning::TrainedPart> RiftTask::parts() { return {{"head", &state_->head}}; }

std::unique_ptr<learning::Stage> RiftTask::makeStage(const std::string&) {
  return std::make_unique<RiftStage>(*state_);
}

learning::TrainedModel RiftTask::finish() {
  std::map<std::string, inference::Tensor> weights = state_->model.weights;
  for (const auto& [name, tensor] : state_->head.values()) weights[name] = tensor;
  learning::TrainedModel model;
  model.files = {
      {kRift.file, {networkMetadata(kRift, state_->model.architecture), weights}, true, ""}};
  model.held_out = RiftStage(*state_).measureHeldOut();
  model.settings = {{"settings", core::dumpOptions(settings)}};
  model.title = "RIFT";
  model.measures = riftTable(model.held_out);
  return model;
}

learning::TaskDescriptor riftTraining() {
  return {"rift", "Fine-tune the scores of the planner pluto by simulated returns",
          []() -> std::shared_ptr<learning::Task> { return std::make_shared<RiftTask>(); }};
}

}  // namespace cdiff::planners
