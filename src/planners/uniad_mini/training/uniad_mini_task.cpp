// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/uniad_mini/training/uniad_mini_task.h"

#include "planners/camera_ego/training/bev_transfer.h"
#include "planners/uniad_mini/training/uniad_mini_stages.h"
#include "planners/uniad_mini/training/uniad_mini_validation.h"

namespace cdiff::planners {
namespace {

constexpr std::size_t kAnchorSamples = 400;

/// `first`: stage to train first where there is none.
learning::PartSource partOf(const char* part, const std::string& what,
                            const std::vector<std::string>& stages, const std::string& first) {
  return {part, what, stages, first};
}

EgoExampleOptions labelsFor(const UniadMiniArchitecture& architecture) {
  EgoExampleOptions labels;
  labels.most_agents = static_cast<std::size_t>(architecture.tracks);
  labels.most_lines = static_cast<std::size_t>(architecture.map_lines);
  labels.past_agents = true;
  return labels;
}

}  // namespace

void UniadMiniTrainingSettings::describe(core::OptionsVisitor& visitor) {
  architecture.describe(visitor);
  samples.describe(visitor);
  visitor.number({"dropped_tracks", "", "Chance that a track is lost from look to look."},
                 drops.dropped, 0.0, 1.0);
  visitor.number({"false_tracks", "", "Chance that a false track goes on to the next look."},
                 drops.false_positive, 0.0, 1.0);
  visitor.flag({"intermediate_losses", "",
                "Supervise tracks, map, motion and occupancy in stage end_to_end."},
               intermediate_losses);
}

learning::TaskTexts UniadMiniTask::texts() const {
  return {"perception, end_to_end", std::to_string(kUniadMiniBatch)};
}

std::vector<learning::StageInfo> UniadMiniTask::stages() const {
  const auto bev = partOf(kBevPart, "a BEV encoder", {kPerceptionStage}, kPerceptionStage);
  const auto track = partOf(kTrackPart, "tracks and map", {kPerceptionStage}, kPerceptionStage);
  return {{kPerceptionStage, {}, false, {}, "train stage end_to_end on this perception next"},
          {kEndToEndStage, {bev, track}, true, {}, ""}};
}

std::vector<std::string> UniadMiniTask::allStages() const {
  return {kPerceptionStage, kEndToEndStage};
}

std::vector<learning::PartSource> UniadMiniTask::model() const {
  return {partOf(kBevPart, "a BEV encoder", {kPerceptionStage}, kPerceptionStage),
          partOf(kTrackPart, "tracks and map", {kEndToEndStage}, kEndToEndStage),
          partOf(kPlanPart, "a planner", {kEndToEndStage}, kEndToEndStage)};
}

std::vector<std::string> UniadMiniTask::fields() const {
  std::vector<std::string> names;
  for (const learning::FieldSpec& field : sceneFields().fields) names.push_back(field.name);
  return names;
}

std::vector<learning::Sample> UniadMiniTask::samplesOf(const learning::Scene& scene) {
  return data_.samplesOf(scene, settings.samples);
}

void UniadMiniTask::setDefaults(learning::TrainingOptions& options) const {
  options.learning_rate = 2e-4;
  options.weight_decay = 0.01;
  options.clip = 35.0;
  options.warm_up = 200;
  options.validation_samples = 400;
}

nlohmann::json UniadMiniTask::facts() const {
  return {{"architecture", core::dumpOptions(settings.architecture)},
          {"samples", core::dumpOptions(settings.samples)},
          {"intermediate_losses", settings.intermediate_losses},
          {"dropped_tracks", settings.drops.dropped},
          {"false_tracks", settings.drops.false_positive},
          {"start", state_ ? state_->start : ""}};
}

void UniadMiniTask::start(const learning::TrainingRun& run) {
  const CameraEgoSizes& ego = settings.architecture.ego;
  data_.start(run, settings.samples, ego.cameras(), ego.bev, labelsFor(settings.architecture));
  const auto seed = static_cast<std::uint64_t>(run.options.seed);
  state_.reset(new UniadTrainingState{run, settings, UniadMiniNet(settings.architecture, seed),
                                      data_, std::nullopt, ""});
  state_->net.setAnchors(clusterAnchors(takenWays(run, data_, kAnchorSamples)));
  if (!run.options.init.empty()) startFrom(run.options.init);
  state_->net.moveTo(run.device);
}

void UniadMiniTask::startFrom(const std::string& init) {
  const std::filesystem::path folder = WeightOptions{init}.folder();
  if (std::filesystem::exists(folder / kVadMini.file)) {
    const VadMiniModel model = readVadMiniModel(folder);
    state_->net.loadBev(
        bevEncoderFor(settings.architecture.ego, {model.architecture.ego, model.weights, init}),
        init);
    state_->start = std::string("BEV encoder of vad_mini, ") + weightSha256(kVadMini, folder);
  } else {
    state_->net.load(readUniadMiniModel(folder).weights, init);
    state_->start = std::string("uniad_mini, ") + weightSha256(kUniadMini, folder);
  }
}

std::vector<learning::TrainedPart> UniadMiniTask::parts() {
  return {{kBevPart, &state_->net.bevParameters()},
          {kTrackPart, &state_->net.trackParameters()},
          {kPlanPart, &state_->net.planParameters()}};
}

std::unique_ptr<learning::Stage> UniadMiniTask::makeStage(const std::string& name) {
  return makeUniadStage(*state_, name);
}

learning::TrainedModel UniadMiniTask::finish() {
  learning::TrainedModel model;
  model.files = {{kUniadMini.file,
                  {networkMetadata(kUniadMini, settings.architecture), state_->net.values()},
                  true,
                  ""}};
  model.held_out = heldOutMeasures(*state_);
  model.settings = facts();
  model.title = "UniAD mini";
  model.measures = uniadTable(model.held_out);
  if (!state_->start.empty())
    model.measures += "\nThe first stage started from: " + state_->start + ".\n";
  return model;
}

std::vector<TakenWay> takenWaysOf(const EgoExample& example) {
  std::vector<TakenWay> ways;
  for (const AgentLabel& label : example.others) {
    if (label.future.known < label.future.places.size()) continue;
    const geometry::Pose2d own{{label.box[0], label.box[1]}, label.heading};
    TakenWay way{motionGroupOf(label.size.length, label.size.width), {}};
    for (std::size_t i = 0; i < way.places.size(); ++i)
      way.places[i] = own.toBody(label.future.places[i]);
    ways.push_back(way);
  }
  return ways;
}

std::vector<TakenWay> takenWays(const learning::TrainingRun& run, EgoData& data, std::size_t most) {
  std::vector<TakenWay> ways;
  const std::vector<std::size_t>& training = run.dataset.training();
  const std::size_t stride = std::max<std::size_t>(1, training.size() / most);
  for (std::size_t i = 0; i < training.size(); i += stride) {
    for (const TakenWay& way : takenWaysOf(data.exampleOf(training[i], 1))) ways.push_back(way);
  }
  return ways;
}

learning::TaskDescriptor uniadMiniTraining() {
  return {"uniad_mini", "Train the planner uniad_mini on collected scenes",
          []() -> std::shared_ptr<learning::Task> { return std::make_shared<UniadMiniTask>(); }};
}

}  // namespace cdiff::planners
