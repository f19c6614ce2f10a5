// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/uniad_mini/training/uniad_mini_stages.h"

#include "learning/samples/sample_order.h"
#include "planners/uniad_mini/training/uniad_losses.h"
#include "planners/uniad_mini/training/uniad_mini_validation.h"

namespace cdiff::planners {
namespace {

constexpr std::size_t kPriorSamples = 400;

std::vector<const EgoExample*> pointersTo(const std::vector<EgoExample>& examples) {
  std::vector<const EgoExample*> views;
  for (const EgoExample& example : examples) views.push_back(&example);
  return views;
}

at::Tensor commandsOf(const std::vector<const EgoExample*>& examples, const at::Device& device) {
  std::vector<std::int64_t> commands;
  for (const EgoExample* example : examples)
    commands.push_back(static_cast<std::int64_t>(example->command));
  return learning::toIndices(commands, {static_cast<std::int64_t>(examples.size())}, device);
}

/// 1 for the slots that labels were matched to [B, A].
at::Tensor matchedSlots(const QueryMatches& matches, std::int64_t slots, const at::Device& device) {
  std::vector<float> sure(matches.size() * static_cast<std::size_t>(slots), 0.0F);
  for (std::size_t b = 0; b < matches.size(); ++b) {
    for (const int slot : matches[b]) {
      if (slot >= 0)
        sure[b * static_cast<std::size_t>(slots) + static_cast<std::size_t>(slot)] = 1.0F;
    }
  }
  return learning::toTensor(sure, {static_cast<std::int64_t>(matches.size()), slots}, device);
}

/// Both stages; they differ in what they train and in which losses count.
class UniadStage : public learning::Stage {
 public:
  UniadStage(UniadTrainingState& state, const std::string& name)
      : state_(state),
        name_(name),
        batch_(state.run.batchSize(kUniadMiniBatch)),
        order_(state.run.dataset.training(), state.data.weights(), batch_,
               state.run.stream("uniad_mini " + name + " order")),
        changes_(state.run.stream("uniad_mini " + name + " changes")),
        drops_(state.run.stream("uniad_mini " + name + " drops")) {}

  const std::string& name() const override { return name_; }
  std::int64_t batchSize() const override { return batch_; }
  std::vector<std::size_t> samplesOf(std::int64_t step) override { return order_.at(step); }
  learning::Measures measureHeldOut() override { return heldOutMeasures(state_); }

  std::vector<learning::TrainedPart> parts() override {
    UniadMiniNet& net = state_.net;
    if (planned())
      return {{kTrackPart, &net.trackParameters()}, {kPlanPart, &net.planParameters()}};
    return {{kBevPart, &net.bevParameters()}, {kTrackPart, &net.trackParameters()}};
  }

  learning::Loss loss(std::int64_t step) override {
    const auto most = static_cast<std::size_t>(state_.settings.samples.past_looks) + 1;
    const std::vector<EgoExample> examples =
        state_.data.examplesOf(samplesOf(step), step, changes_, most);
    const std::vector<const EgoExample*> views = pointersTo(examples);
    const FollowOptions options{state_.run.device, state_.settings.drops, {}};
    const FollowedTracks tracks = followTracks(state_.net, views, options, drops_, step);
    const MapAnswer map = state_.net.seeMap(tracks.bev, batch_);
    learning::Loss loss;
    if (!planned() || state_.settings.intermediate_losses) addPerception(tracks, map, views, loss);
    if (planned()) addPlan(tracks, map, views, loss);
    return loss;
  }

 private:
  bool planned() const { return name_ == kEndToEndStage; }

  void addPerception(const FollowedTracks& tracks, const MapAnswer& map,
                     const std::vector<const EgoExample*>& views, learning::Loss& loss) const {
    const SetLossWeights weights;
    loss.add("track_class", tracks.kind);
    loss.add("track_box", tracks.box);
    loss.add("ego_velocity", egoVelocityLoss(tracks.answer, views));
    for (std::size_t i = 0; i < map.lines.size(); ++i) {
      const LineLoss lines = lineLoss(map.logits[i], map.lines[i], views,
                                      state_.settings.architecture.ego.bev, weights);
      loss.add("line_class", lines.kind);
      loss.add("line_points", lines.points);
      loss.add("line_direction", lines.direction);
    }
  }

  void addPlan(const FollowedTracks& tracks, const MapAnswer& map,
               const std::vector<const EgoExample*>& views, learning::Loss& loss) const {
    const UniadMiniArchitecture& architecture = state_.settings.architecture;
    const MotionAnswer motion = state_.net.forecast(tracks.bev, tracks.answer, map);
    if (state_.settings.intermediate_losses) {
      loss.add("motion",
               motionLoss(motion, motionTargets(views, tracks.matches, architecture.rows())));
      const at::Tensor sure = matchedSlots(tracks.matches, architecture.tracks, state_.run.device);
      loss.add("occupancy",
               occupancyLoss(state_.net.occupancy(tracks.bev, tracks.answer, motion, sure),
                             architecture.ego.bev, views, tracks.matches));
    }
    const at::Tensor plans =
        state_.net.plan(tracks.bev, tracks.answer, motion, commandsOf(views, state_.run.device));
    loss.add("plan", averageDisplacement(plans, views));
    for (std::size_t i = 0; i < std::size(UniadLossOptions::kInflations); ++i)
      loss.add("plan_collision", UniadLossOptions::kInflationWeights[i] *
                                     overlapLoss(plans, views, UniadLossOptions::kInflations[i]));
  }

  UniadTrainingState& state_;
  std::string name_;
  std::int64_t batch_;
  learning::SampleOrder order_;
  core::RandomStream changes_;
  core::RandomStream drops_;
};

}  // namespace

std::unique_ptr<learning::Stage> makeUniadStage(UniadTrainingState& state,
                                                const std::string& name) {
  return std::make_unique<UniadStage>(state, name);
}

learning::Measures heldOutMeasures(UniadTrainingState& state) {
  if (!state.prior)
    state.prior.emplace(state.data.agentCenters(kPriorSamples),
                        static_cast<std::size_t>(state.settings.architecture.tracks));
  UniadMiniValidation validation({state.settings.architecture, state.net.values()}, *state.prior);
  const auto looks = static_cast<std::size_t>(state.settings.samples.past_looks) + 1;
  for (const std::size_t index : state.run.held_out)
    validation.add(state.data.exampleOf(index, looks));
  return validation.measures();
}

}  // namespace cdiff::planners
