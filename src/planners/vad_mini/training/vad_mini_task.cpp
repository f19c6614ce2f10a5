// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/vad_mini/training/vad_mini_task.h"

#include "learning/samples/sample_order.h"
#include "planners/camera_ego/training/ego_batch.h"
#include "planners/vad_mini/training/vad_mini_judge.h"

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
  ImitationOfEgos(const learning::TrainingRun& run, const VadMiniTrainingSettings& settings,
                  VadMiniNet& net, EgoData& data, std::optional<ConstantDetections>& prior)
      : run_(run),
        settings_(settings),
        net_(net),
        data_(data),
        prior_(prior),
        batch_(run.batchSize(kVadMiniBatch)),
        order_(run.dataset.training(), data.weights(), batch_, run.stream("vad_mini order")),
        changes_(run.stream("vad_mini changes")) {}

  const std::string& name() const override { return name_; }
  std::vector<learning::TrainedPart> parts() override {
    return {{VadMiniTask::kPart, &net_.parameters()}};
  }
  std::int64_t batchSize() const override { return batch_; }
  std::vector<std::size_t> samplesOf(std::int64_t step) override { return order_.at(step); }

  learning::Loss loss(std::int64_t step) override {
    const CameraEgoSizes& sizes = settings_.architecture.ego;
    const std::vector<EgoExample> examples =
        data_.examplesOf(samplesOf(step), step, changes_, looks());
    const std::vector<const EgoExample*> views = viewsOf(examples);
    const at::Tensor bev = encodeLooks(net_.bev(), views, sizes, run_.device);
    VadMiniLossOptions options;
    options.intermediate = settings_.intermediate_losses;
    options.constraints = static_cast<double>(step) >=
                          settings_.constraint_start * static_cast<double>(run_.options.steps);
    return vadMiniLoss(net_.answer(bev, batch_), sizes.bev, views, options);
  }

  learning::Measures judge() override {
    if (!prior_)
      prior_.emplace(data_.agentCenters(kPriorSamples),
                     static_cast<std::size_t>(settings_.architecture.agents));
    VadMiniJudge judge({settings_.architecture, net_.parameters().values()}, *prior_);
    for (const std::size_t index : run_.held_out) judge.add(data_.exampleOf(index, looks()));
    return judge.measures();
  }

 private:
  std::size_t looks() const {
    const auto past = static_cast<std::size_t>(settings_.samples.past_looks);
    return settings_.architecture.ego.past_bev ? past + 1 : 1;
  }

  std::string name_ = kVadMiniStage;
  const learning::TrainingRun& run_;
  const VadMiniTrainingSettings& settings_;
  VadMiniNet& net_;
  EgoData& data_;
  std::optional<ConstantDetections>& prior_;
  std::int64_t batch_;
  learning::SampleOrder order_;
  core::RandomStream changes_;
};

}  // namespace

void VadMiniTrainingSettings::describe(core::OptionsVisitor& visitor) {
  architecture.describe(visitor);
  samples.describe(visitor);
  visitor.flag({"intermediate_losses", "", "Whether detection, forecasts and map are supervised."},
               intermediate_losses);
  visitor.number({"constraint_start", "", "Part of the steps before the plan's constraints count."},
                 constraint_start, 0.0, 1.0);
}

VadMiniTask::VadMiniTask()
    : NetworkTask({kVadMini, "VAD mini", kVadMiniStage, kVadMiniBatch, vadMiniTensors}) {}

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
  return facts;
}

void VadMiniTask::start(const learning::TrainingRun& run) {
  run_ = &run;
  net_ = std::make_unique<VadMiniNet>(settings.architecture,
                                      static_cast<std::uint64_t>(run.options.seed));
  const CameraEgoSizes& ego = settings.architecture.ego;
  data_.start(run, settings.samples, ego.cameras(), ego.bev);
  loadWeights(run);
}

std::unique_ptr<learning::Stage> VadMiniTask::makeStage(const std::string&) {
  return std::make_unique<ImitationOfEgos>(*run_, settings, *net_, data_, prior_);
}

std::string VadMiniTask::table(const learning::Measures& held_out) const {
  return egoTable(held_out, "VAD mini");
}

learning::TaskDescriptor vadMiniTraining() {
  return {"vad_mini", "Train the planner vad_mini on collected scenes",
          []() -> std::shared_ptr<learning::Task> { return std::make_shared<VadMiniTask>(); }};
}

}  // namespace cdiff::planners
