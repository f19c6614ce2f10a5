// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/pluto/training/pluto_task.h"

#include "planners/pluto/training/pluto_losses.h"
#include "planners/pluto/training/pluto_validation.h"

namespace cdiff::planners {
namespace {

constexpr const char* kPlutoStage = "imitation";
constexpr std::int64_t kPlutoBatch = 32;

/// The examples of a step: recorded moments, each followed by the changed ones of its triplet.
struct StepExamples {
  std::vector<std::unique_ptr<PlutoExample>> owned;
  std::vector<Triplet> triplets;

  std::int64_t add(PlutoExample example) {
    owned.push_back(std::make_unique<PlutoExample>(std::move(example)));
    return static_cast<std::int64_t>(owned.size()) - 1;
  }
  std::vector<const PlutoExample*> list() const {
    std::vector<const PlutoExample*> all;
    for (const auto& example : owned) all.push_back(example.get());
    return all;
  }
};

class ImitationOfPlans : public learning::EvenStage {
 public:
  explicit ImitationOfPlans(PlutoTrainingState& state)
      : EvenStage(state.run, kPlutoStage, {PlutoTask::kPart, &state.net.parameters()}, kPlutoBatch,
                  "pluto order"),
        state_(state),
        dropout_(state.run.stream("pluto dropout")),
        changes_(state.run.stream("pluto changes")),
        disturbances_(state.run.stream("pluto disturbances")) {}

  learning::Loss loss(std::int64_t step) override {
    const StepExamples examples = examplesOf(step);
    const std::vector<const PlutoExample*> all = examples.list();
    const PlutoBatch batch = plutoBatch(all, dropoutOf(step, all.size()), state_.run.device);
    return plutoLoss(state_.net, batch, all, factorsOf(step, all.size()), examples.triplets);
  }

  learning::Measures measureHeldOut() override {
    PlutoValidation validation({state_.settings.architecture, state_.net.parameters().values()});
    for (const std::size_t index : state_.run.held_out) {
      const PlutoPlace& place = state_.places[index];
      validation.add(state_.scenes[place.scene], place);
    }
    return validation.measures();
  }

 private:
  bool contrasts(std::int64_t step) const {
    const double share = static_cast<double>(step) / static_cast<double>(state_.run.options.steps);
    return share >= 1.0 - state_.settings.contrast_share;
  }

  StepExamples examplesOf(std::int64_t step) {
    StepExamples examples;
    std::uint64_t row = 0;
    for (const std::size_t index : samplesOf(step)) {
      const PlutoPlace& place = state_.places[index];
      const PlutoScene& scene = state_.scenes[place.scene];
      const core::RandomKey key{row++, static_cast<std::uint32_t>(step), 0};
      ChangedMoment changed(scene.moment(place.decision, place.drive));
      disturbOften(changed, key);
      const std::int64_t anchor = examples.add(plutoExample(scene, place, changed.moment, true));
      if (contrasts(step)) addTriplet(scene, place, {changes_, key}, anchor, examples);
    }
    return examples;
  }

  /// Off the way that was driven with the chance that the settings name.
  void disturbOften(ChangedMoment& changed, const core::RandomKey& key) const {
    constexpr std::uint32_t kChance = 6;  // behind the elements that disturbOwn draws
    if (disturbances_.uniform(key, kChance) < state_.settings.disturbed_share)
      disturbOwn(changed, state_.settings.disturbance, {disturbances_, key});
  }

  /// Anchors and negatives are disturbed alike, so that no contrast is learned from that.
  void addTriplet(const PlutoScene& scene, const PlutoPlace& place, const ExampleDraws& draws,
                  std::int64_t anchor, StepExamples& examples) {
    const auto negative = negativeMoment(scene, place, draws);
    if (negative == nullptr) return;
    const core::RandomKey& key = draws.key;
    disturbOften(*negative, {key.vehicle, key.decision, 1});
    const auto positive = positiveMoment(scene, place, draws);
    const std::int64_t first = examples.add(plutoExample(scene, place, positive->moment, true));
    const std::int64_t second = examples.add(plutoExample(scene, place, negative->moment, false));
    examples.triplets.push_back({anchor, first, second});
  }

  PlutoDropout dropoutOf(std::int64_t step, std::size_t count) const {
    PlutoDropout dropout;
    for (std::size_t i = 0; i < count; ++i) {
      const core::RandomKey key{i, static_cast<std::uint32_t>(step), 0};
      dropout.motion.emplace_back();
      for (std::uint32_t n = 0; n < kMotionNumbers; ++n)
        dropout.motion.back()[n] = dropout_.uniform(key, n) < state_.settings.motion_dropout;
      const bool cut = dropout_.uniform(key, kMotionNumbers) < state_.settings.history_dropout;
      const auto shown = static_cast<std::int64_t>(
          dropout_.index(key, kMotionNumbers + 1, static_cast<std::size_t>(kPlutoHistory)));
      dropout.history.push_back(cut ? shown : kPlutoHistory);
    }
    return dropout;
  }

  LayerFactors factorsOf(std::int64_t step, std::size_t count) const {
    const double share = state_.settings.layer_dropout;
    LayerFactors factors;
    const auto halves = static_cast<std::uint16_t>(2 * state_.settings.architecture.encoder_layers);
    for (std::uint16_t half = 1; half <= halves; ++half) {
      std::vector<float> values;
      for (std::size_t i = 0; i < count; ++i) {
        const core::RandomKey key{i, static_cast<std::uint32_t>(step), half};
        const bool left_out = dropout_.uniform(key, 0) < share;
        values.push_back(left_out ? 0.0F : static_cast<float>(1.0 / (1.0 - share)));
      }
      factors.push_back(
          learning::toTensor(values, {static_cast<std::int64_t>(count), 1, 1}, state_.run.device));
    }
    return factors;
  }

  PlutoTrainingState& state_;
  core::RandomStream dropout_;
  core::RandomStream changes_;
  core::RandomStream disturbances_;
};

}  // namespace

void PlutoTrainingSettings::describe(core::OptionsVisitor& visitor) {
  architecture.describe(visitor);
  samples.describe(visitor);
  visitor.number({"motion_dropout", "",
                  "Chance that speed, acceleration or steer, each by itself, is not shown."},
                 motion_dropout, 0.0, 1.0);
  visitor.number({"history_dropout", "", "Chance that less of the history is shown."},
                 history_dropout, 0.0, 1.0);
  visitor.number({"layer_dropout", "", "Chance that a step of the encoder is left out."},
                 layer_dropout, 0.0, 0.9);
  visitor.number({"disturbed_share", "",
                  "Chance that a moment is one off the way that was driven, with a way back."},
                 disturbed_share, 0.0, 1.0);
  visitor.number({"disturbed_across", "m", "Most that such a moment is off to the side."},
                 disturbance.across, 0.0, 5.0);
  visitor.number({"disturbed_turn", "rad", "Most that such a moment is turned."}, disturbance.turn,
                 0.0, 1.0);
  visitor.number({"contrast_share", "", "Last part of the steps that learns from triplets, too."},
                 contrast_share, 0.0, 1.0);
}

PlutoTask::PlutoTask()
    : NetworkTask({kPluto, "Pluto", kPlutoStage, kPlutoBatch, plutoTensors, plutoFields}) {}

std::vector<learning::Sample> PlutoTask::samplesOf(const learning::Scene& scene) {
  if (!worlds_) worlds_.emplace(settings.architecture);
  const auto number = static_cast<std::uint32_t>(scenes_.size());
  scenes_.emplace_back(scene, worlds_->of(scene));
  std::vector<learning::Sample> samples;
  for (const PlutoPlace& place : plutoPlaces(scenes_.back(), number, settings.samples))
    samples.push_back(toSample(place, scenes_.back()));
  return samples;
}

void PlutoTask::setDefaults(learning::TrainingOptions& options) const {
  options.learning_rate = 1e-3;
  options.weight_decay = 1e-4;
  options.clip = 5.0;
  options.validation_samples = 1000;
}

void PlutoTask::start(const learning::TrainingRun& run) {
  const auto seed = static_cast<std::uint64_t>(run.options.seed);
  state_.reset(
      new PlutoTrainingState{run, settings, PlutoNet(settings.architecture, seed), scenes_, {}});
  for (std::size_t i = 0; i < run.dataset.size(); ++i)
    state_->places.push_back(toPlutoPlace(run.dataset.sample(i)));
  loadWeights(run);
}

nlohmann::json PlutoTask::facts() const {
  nlohmann::json facts = NetworkTask::facts();
  facts["settings"] = core::dumpOptions(settings);
  return facts;
}

std::unique_ptr<learning::Stage> PlutoTask::makeStage(const std::string&) {
  return std::make_unique<ImitationOfPlans>(*state_);
}

std::string PlutoTask::table(const learning::Measures& held_out) const {
  return plutoTable(held_out);
}

learning::TaskDescriptor plutoTraining() {
  return {"pluto", "Train the planner pluto on collected scenes",
          []() -> std::shared_ptr<learning::Task> { return std::make_shared<PlutoTask>(); }};
}

}  // namespace cdiff::planners
