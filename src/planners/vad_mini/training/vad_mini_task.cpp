// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/vad_mini/training/vad_mini_task.h"

#include "core/file.h"
#include "planners/camera_ego/training/ego_batch.h"
#include "planners/vad_mini/training/vad_mini_validation.h"

namespace cdiff::planners {
namespace {

constexpr const char* kVadMiniStage = "imitation";
constexpr std::int64_t kVadMiniBatch = 16;
constexpr std::size_t kPriorSamples = 400;

std::vector<const EgoExample*> viewsOf(const std::vector<EgoExample>& examples) {
  std::vector<const EgoExample*> views;
  for (const EgoExample& example : examples) views.push_back(&example);
  return views;
}

/// Imitation with balanced classes of moments.
class ImitationOfEgos : public learning::Stage {
 public:
  explicit ImitationOfEgos(VadMiniTrainingState& state)
      : state_(state),
        batch_(state.run.batchSize(kVadMiniBatch)),
        order_(state.run.dataset.training(), state.data.weights(), batch_,
               state.run.stream("vad_mini order")),
        changes_(state.run.stream("vad_mini changes")) {}

  const std::string& name() const override { return name_; }
  std::vector<learning::TrainedPart> parts() override {
    return {{VadMiniTask::kPart, &state_.net.parameters()}};
  }
  std::int64_t batchSize() const override { return batch_; }
  std::vector<std::size_t> samplesOf(std::int64_t step) override { return order_.at(step); }

  learning::Loss loss(std::int64_t step) override {
    const CameraEgoSizes& sizes = state_.settings.architecture.ego;
    const std::vector<EgoExample> examples =
        state_.data.examplesOf(samplesOf(step), step, changes_, looksAt(step));
    const std::vector<const EgoExample*> views = viewsOf(examples);
    const at::Tensor bev = encodeFrames(state_.net.bev(), views, sizes, state_.run.device);
    return vadMiniLoss(state_.net.answer(bev, batch_), sizes.bev, views, optionsOf(step));
  }

  learning::Measures measureHeldOut() override {
    const VadMiniArchitecture& architecture = state_.settings.architecture;
    if (!state_.prior)
      state_.prior.emplace(state_.data.agentCenters(kPriorSamples),
                           static_cast<std::size_t>(architecture.agents));
    VadMiniValidation validation({architecture, state_.net.parameters().values()}, *state_.prior);
    for (const std::size_t index : state_.run.held_out)
      validation.add(state_.data.exampleOf(index, looks()));
    const std::string& file = state_.settings.judged_by_network;
    if (!file.empty()) core::writeFileAtomically(file, validation.byNetwork());
    return validation.measures();
  }

 private:
  VadMiniLossOptions optionsOf(std::int64_t step) const {
    VadMiniLossOptions options;
    options.intermediate = state_.settings.intermediate_losses;
    options.constraints = isPast(state_.settings.constraint_start, step);
    return options;
  }
  /// Whether a part of the steps lies behind a step.
  bool isPast(double part, std::int64_t step) const {
    return static_cast<double>(step) >= part * static_cast<double>(state_.run.options.steps);
  }
  std::size_t looksAt(std::int64_t step) const {
    return isPast(state_.settings.past_start, step) ? looks() : 1;
  }
  std::size_t looks() const {
    const auto past = static_cast<std::size_t>(state_.settings.samples.past_looks);
    return state_.settings.architecture.ego.past_bev ? past + 1 : 1;
  }

  std::string name_ = kVadMiniStage;
  VadMiniTrainingState& state_;
  std::int64_t batch_;
  learning::SampleOrder order_;
  core::RandomStream changes_;
};

}  // namespace

void VadMiniTrainingSettings::describe(core::OptionsVisitor& visitor) {
  architecture.describe(visitor);
  samples.describe(visitor);
  visitor.flag({"intermediate_losses", "", "Supervise detection, forecasts and map."},
               intermediate_losses);
  visitor.number({"constraint_start", "", "Part of the steps before the plan's constraints count."},
                 constraint_start, 0.0, 1.0);
  visitor.number({"past_start", "", "Part of the steps before past looks are encoded."}, past_start,
                 0.0, 1.0);
  visitor.text({"judged_by_network", "", "CSV file for the held-out measures of each network."},
               judged_by_network, {});
}

VadMiniTask::VadMiniTask()
    : NetworkTask(
          {kVadMini, "VAD mini", kVadMiniStage, kVadMiniBatch, vadMiniTensors, plutoFields}) {}

std::vector<learning::Sample> VadMiniTask::samplesOf(const learning::Scene& scene) {
  return data_.samplesOf(scene, settings.samples);
}

void VadMiniTask::setDefaults(learning::TrainingOptions& options) const {
  options.learning_rate = 4e-4;
  options.weight_decay = 0.01;
  options.clip = 35.0;
  options.warm_up = 200;
  options.validation_samples = 400;
}

nlohmann::json VadMiniTask::facts() const {
  nlohmann::json facts = NetworkTask::facts();
  facts["samples"] = core::dumpOptions(settings.samples);
  facts["intermediate_losses"] = settings.intermediate_losses;
  facts["constraint_start"] = settings.constraint_start;
  facts["past_start"] = settings.past_start;
  return facts;
}

void VadMiniTask::start(const learning::TrainingRun& run) {
  const auto seed = static_cast<std::uint64_t>(run.options.seed);
  state_.reset(new VadMiniTrainingState{run, settings, VadMiniNet(settings.architecture, seed),
                                        data_, std::nullopt});
  const CameraEgoSizes& ego = settings.architecture.ego;
  data_.start(run, settings.samples, ego.cameras(), ego.bev);
  loadWeights(run);
}

std::unique_ptr<learning::Stage> VadMiniTask::makeStage(const std::string&) {
  return std::make_unique<ImitationOfEgos>(*state_);
}

std::string VadMiniTask::table(const learning::Measures& held_out) const {
  return egoTable(held_out, "VAD mini");
}

learning::TaskDescriptor vadMiniTraining() {
  return {"vad_mini", "Train the planner vad_mini on collected scenes",
          []() -> std::shared_ptr<learning::Task> { return std::make_shared<VadMiniTask>(); }};
}

}  // namespace cdiff::planners
