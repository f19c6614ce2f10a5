// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/plant/training/plant_task.h"

#include "core/text.h"

namespace cdiff::planners {
namespace {

using learning::Measures;

constexpr const char* kPlantStage = "imitation";
constexpr std::int64_t kPlantBatch = 64;

/// Sums of distances between planned and driven places.
struct DisplacementSums {
  double all = 0.0;   ///< over the four waypoints
  double last = 0.0;  ///< at 2 s

  void add(const PlantWaypoints& planned, const PlantWaypoints& driven) {
    for (std::size_t i = 0; i < planned.size(); ++i) {
      const double distance = (planned[i] - driven[i]).norm();
      all += distance / static_cast<double>(planned.size());
      if (i + 1 == planned.size()) last += distance;
    }
  }
  void report(const std::string& prefix, double count, Measures& measures) const {
    measures[prefix + "ade_m"] = all / count;
    measures[prefix + "fde_m"] = last / count;
  }
};

PlantWaypoints atConstantSpeed(double speed) {
  PlantWaypoints places;
  for (std::size_t i = 0; i < places.size(); ++i)
    places[i] = {speed * kPlantWaypointPeriod * static_cast<double>(i + 1), 0.0};
  return places;
}

class ImitationOfWaypoints : public learning::EvenStage {
 public:
  explicit ImitationOfWaypoints(PlantTrainingState& state)
      : EvenStage(state.run, kPlantStage, {PlantTask::kPart, &state.net.parameters()}, kPlantBatch,
                  "plant order"),
        state_(state) {}

  /// Mean absolute error of the waypoints' coordinates [m] plus the mean of the cross entropies of
  /// the six attributes 0.5 s later.
  learning::Loss loss(std::int64_t step) override {
    std::vector<const PlantExample*> examples;
    for (const std::size_t index : samplesOf(step)) examples.push_back(&state_.examples[index]);
    const PlantBatch batch = plantBatch(examples, state_.run.device);
    const PlantNet::Result result = state_.net.forward(batch);
    const at::Tensor waypoints = (result.waypoints - batch.driven).abs().mean();
    learning::Loss loss{waypoints, {{"waypoints", waypoints}}};
    if (batch.places.size(0) == 0) return loss;
    at::Tensor next = at::zeros({}, waypoints.options());
    for (std::size_t i = 0; i < result.next.size(); ++i) {
      const at::Tensor logs = at::log_softmax(result.next[i], 1);
      next = next - logs.gather(1, batch.next[i].unsqueeze(1)).mean() / kPlantAttributes;
    }
    loss.total = waypoints + next;
    loss.terms.emplace_back("next", next);
    return loss;
  }

  /// By the planner's own network; beside it a vehicle that stands, and one that keeps its speed
  /// straight on.
  Measures measureHeldOut() override {
    PlantNetwork network({state_.architecture, state_.net.parameters().values()});
    DisplacementSums planned, standing, constant;
    for (const std::size_t index : state_.run.held_out) {
      const PlantExample& example = state_.examples[index];
      planned.add(network.forward({example.input}).front().waypoints, example.driven);
      standing.add(atConstantSpeed(0.0), example.driven);
      constant.add(atConstantSpeed(example.speed), example.driven);
    }
    const auto count = static_cast<double>(state_.run.held_out.size());
    Measures measures;
    planned.report("", count, measures);
    standing.report("standing_", count, measures);
    constant.report("constant_speed_", count, measures);
    return measures;
  }

 private:
  PlantTrainingState& state_;
};

}  // namespace

PlantTask::PlantTask()
    : NetworkTask({kPlant, "PlanT", kPlantStage, kPlantBatch, plantTensors, plantFields}) {}

std::vector<learning::Sample> PlantTask::samplesOf(const learning::Scene& scene) {
  if (!sampler_) sampler_.emplace(settings.architecture, settings.samples);
  std::vector<learning::Sample> samples;
  for (const PlantExample& example : sampler_->examplesOf(scene))
    samples.push_back(toSample(example));
  return samples;
}

void PlantTask::setDefaults(learning::TrainingOptions& options) const {
  options.learning_rate = 3e-4;
  options.weight_decay = 0.1;
  options.second_decay = 0.95;
  options.validation_samples = 2000;
}

void PlantTask::start(const learning::TrainingRun& run) {
  const auto seed = static_cast<std::uint64_t>(run.options.seed);
  state_.reset(new PlantTrainingState{
      run, settings.architecture, PlantNet(settings.architecture, seed), {}});
  for (std::size_t i = 0; i < run.dataset.size(); ++i)
    state_->examples.push_back(toExample(run.dataset.sample(i)));
  loadWeights(run);
}

std::unique_ptr<learning::Stage> PlantTask::makeStage(const std::string&) {
  return std::make_unique<ImitationOfWaypoints>(*state_);
}

std::string PlantTask::table(const Measures& held_out) const {
  std::string table =
      "Distance to where the expert drove: mean over 0.5, 1.0, 1.5 and 2.0 s, and at 2 s [m].\n\n"
      "| Prediction | mean | at 2 s |\n|---|---|---|\n";
  const std::pair<const char*, const char*> rows[] = {
      {"PlanT", ""}, {"stands", "standing_"}, {"keeps its speed straight on", "constant_speed_"}};
  for (const auto& [title, prefix] : rows) {
    table += "| " + std::string(title) + " | " +
             core::formatFixed(held_out.at(std::string(prefix) + "ade_m"), 3) + " | " +
             core::formatFixed(held_out.at(std::string(prefix) + "fde_m"), 3) + " |\n";
  }
  return table;
}

learning::TaskDescriptor plantTraining() {
  return {"plant", "Train the planner plant on collected scenes",
          []() -> std::shared_ptr<learning::Task> { return std::make_shared<PlantTask>(); }};
}

}  // namespace cdiff::planners
