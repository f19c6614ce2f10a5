// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/diffusion/training/diffusion_stages.h"

#include <algorithm>

#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "learning/batches.h"

namespace cdiff::planners {

void DiffusionTrainingSettings::describe(core::OptionsVisitor& visitor) {
  visitor.text({"precision", "", "Precision of the encoder in training."}, precision,
               {"auto", "f32", "bf16"});
  visitor.text({"network", "",
                "Inputs of the denoiser: image, route and speed; the paper's, the image alone; "
                "that and the current state, pinned; or also the image of 0.4 s before and the "
                "target speed."},
               network, {"default", "paper", "pinned", "motion"});
  visitor.text({"loss", "", "Loss of diffusion stages: first actions weighted, or the paper's."},
               loss, {"weighted", "plain"});
  visitor.number({"image_scale", "", "Size of images in stage encoder: 1 or 0.5."}, image_scale,
                 0.5, 1.0);
  visitor.number({"route_drop", "", "Share of samples without route."}, route_drop, 0.0, 1.0);
  visitor.number({"balance", "", "Rare kinds of driving: 0 as collected, 1 all equally often."},
                 balance, 0.0, 1.0);
  visitor.number({"yielding_share", "", "Part kept of samples that stop to give way."},
                 yielding_share, 0.0, 1.0);
  visitor.flag({"mirror", "", "Mirror every second sample."}, mirror);
  visitor.flag({"light", "", "Change the light of images."}, change_light);
}

diffusion::Architecture DiffusionTrainingSettings::sizes() const {
  if (network == "paper") return architecture.imageAlone();
  if (network == "pinned") return architecture.pinned();
  return network == "motion" ? architecture.withMotion() : architecture;
}

void DiffusionTrainingSettings::validate() const {
  if (image_scale == 1.0 || image_scale == 0.5) return;
  throw core::InputError("training: image_scale is " + core::formatNumber(image_scale) +
                         "; expected 1 or 0.5");
}

namespace {

using learning::Loss;
using learning::Measures;
using learning::TrainedPart;

constexpr std::int64_t kImageBatch = 32;
constexpr std::int64_t kFeatureBatch = 128;
/// The regression head must also do without a route, so that features show where the road goes.
constexpr double kHeadRouteDrop = 0.5;
constexpr std::size_t kEncodeBatch = 32;

BatchOptions batchOptions(const TrainingState& state, const std::string& stage,
                          std::int64_t default_batch) {
  const DiffusionTrainingSettings& settings = state.settings;
  BatchOptions result;
  result.stage = stage;
  result.batch = state.run.batchSize(default_batch);
  result.route_drop = settings.route_drop;
  result.with_motion = state.architecture.takesPrevious();
  result.balance = settings.balance;
  result.yielding_share = settings.yielding_share;
  result.mirror = settings.mirror;
  result.change_light = settings.change_light;
  result.diffusion_steps = state.architecture.diffusion_steps;
  result.seed = static_cast<std::uint64_t>(state.run.options.seed);
  return result;
}

/// Mean squared error of the auxiliary targets that are known, as the regression head predicts them
/// after the cells of the rollout.
at::Tensor auxiliaryLoss(const at::Tensor& predicted, const TrainingBatch& batch) {
  const std::int64_t cells = batch.rollouts.size(1) * batch.rollouts.size(2);
  const at::Tensor error = predicted.narrow(1, cells, batch.auxiliary.size(1)) - batch.auxiliary;
  return (error.pow(2) * batch.auxiliary_known).sum() / batch.auxiliary_known.sum().clamp_min(1.0);
}

class EncoderStage : public learning::Stage {
 public:
  EncoderStage(TrainingState& state, const std::string& name, double image_scale)
      : state_(state),
        name_(name),
        options_(makeOptions(state, name, image_scale)),
        batches_(state.dataset, state.normalizer, options_, state.run.device) {}

  const std::string& name() const override { return name_; }
  std::int64_t batchSize() const override { return options_.batch; }
  std::vector<TrainedPart> parts() override {
    return {{"encoder", &state_.encoder.parameters()}, {"head", &state_.head.parameters()}};
  }
  std::vector<std::size_t> samplesOf(std::int64_t step) override { return batches_.order(step); }

  Loss loss(std::int64_t step) override {
    TrainingBatch batch = batches_.training(step);
    state_.encoder.setHalfPrecision(state_.half_precision);
    const at::Tensor predicted = predict(batch);
    state_.encoder.setHalfPrecision(false);
    const std::int64_t cells = batch.rollouts.size(1) * batch.rollouts.size(2);
    const at::Tensor rollout_loss =
        (predicted.narrow(1, 0, cells) - batch.rollouts.flatten(1)).pow(2).mean();
    Loss loss{rollout_loss, {{"rollout", rollout_loss}}};
    if (batch.auxiliary.size(1) == 0) return loss;
    const at::Tensor auxiliary_loss = auxiliaryLoss(predicted, batch);
    loss.total = rollout_loss + auxiliary_loss;
    loss.terms.emplace_back("auxiliary", auxiliary_loss);
    return loss;
  }

  Measures measureHeldOut() override {
    const at::NoGradGuard no_gradient;
    std::vector<at::Tensor> clean, with_route, without;
    for (std::size_t begin = 0; begin < state_.run.held_out.size(); begin += kEncodeBatch) {
      const std::size_t end = std::min(begin + kEncodeBatch, state_.run.held_out.size());
      TrainingBatch batch =
          batches_.plain({state_.run.held_out.begin() + static_cast<std::ptrdiff_t>(begin),
                          state_.run.held_out.begin() + static_cast<std::ptrdiff_t>(end)},
                         true);
      clean.push_back(batch.rollouts);
      with_route.push_back(rolloutOf(predict(batch), batch.rollouts));
      batch.context.has_route = at::zeros_like(batch.context.has_route);
      without.push_back(rolloutOf(state_.head.forward(batch.context), batch.rollouts));
    }
    Measures measures;
    state_.loss.addMeasures("regression_", at::cat(with_route), at::cat(clean), measures);
    state_.loss.addMeasures("regression_no_route_", at::cat(without), at::cat(clean), measures);
    return measures;
  }

 private:
  static BatchOptions makeOptions(const TrainingState& state, const std::string& name,
                                  double image_scale) {
    BatchOptions options = batchOptions(state, name, kImageBatch);
    options.image_scale = image_scale;
    options.route_drop = kHeadRouteDrop;
    options.with_motion = false;
    return options;
  }

  at::Tensor predict(TrainingBatch& batch) const {
    batch.context.features = state_.encoder.forward(batch.images);
    return state_.head.forward(batch.context);
  }

  static at::Tensor rolloutOf(const at::Tensor& predicted, const at::Tensor& like) {
    return predicted.narrow(1, 0, like.size(1) * like.size(2)).reshape(like.sizes());
  }

  TrainingState& state_;
  std::string name_;
  BatchOptions options_;
  BatchMaker batches_;
};

class DiffusionStage : public learning::Stage {
 public:
  DiffusionStage(TrainingState& state, const std::string& name, const FeatureCache* cache)
      : state_(state),
        name_(name),
        cache_(cache),
        options_(batchOptions(state, name, cache == nullptr ? kImageBatch : kFeatureBatch)),
        batches_(state.dataset, state.normalizer, options_, state.run.device) {
    if (cache_ != nullptr) held_out_ = encodeHeldOut(state_);
  }

  const std::string& name() const override { return name_; }
  std::int64_t batchSize() const override { return options_.batch; }
  std::vector<TrainedPart> parts() override {
    std::vector<TrainedPart> parts = {{"denoiser", &state_.denoiser.parameters()}};
    if (cache_ != nullptr) return parts;
    parts.push_back({"encoder", &state_.encoder.parameters()});
    if (hasTargets()) parts.push_back({"head", &state_.head.parameters()});
    return parts;
  }
  std::vector<std::size_t> samplesOf(std::int64_t step) override { return batches_.order(step); }

  Loss loss(std::int64_t step) override {
    TrainingBatch batch = batches_.training(step, cache_);
    if (cache_ == nullptr) encode(batch);
    Loss loss = state_.loss.loss(state_.denoiser, batch);
    if (cache_ != nullptr || !hasTargets()) return loss;
    const at::Tensor auxiliary = auxiliaryLoss(state_.head.forward(batch.context), batch);
    loss.total = loss.total + auxiliary;
    loss.terms.emplace_back("auxiliary", auxiliary);
    return loss;
  }

  Measures measureHeldOut() override {
    if (cache_ == nullptr) held_out_ = encodeHeldOut(state_);
    return state_.loss.measureHeldOut(state_.denoiser, held_out_.batch, held_out_.gray_features);
  }

 private:
  bool hasTargets() const { return !state_.dataset.schema().auxiliary.empty(); }

  /// The image before is encoded without a gradient: that takes a third of the time, and the same
  /// weights learn from the image.
  void encode(TrainingBatch& batch) const {
    state_.encoder.setHalfPrecision(state_.half_precision);
    batch.context.features = state_.encoder.forward(batch.images);
    if (options_.with_motion) {
      const at::NoGradGuard no_gradient;
      batch.context.previous = state_.encoder.forward(batch.previous_images);
    }
    state_.encoder.setHalfPrecision(false);
  }

  TrainingState& state_;
  std::string name_;
  const FeatureCache* cache_;
  BatchOptions options_;
  BatchMaker batches_;
  HeldOut held_out_;
};

}  // namespace

std::unique_ptr<learning::Stage> makeEncoderStage(TrainingState& state, const std::string& name,
                                                  double image_scale) {
  return std::make_unique<EncoderStage>(state, name, image_scale);
}

std::unique_ptr<learning::Stage> makeDiffusionStage(TrainingState& state, const std::string& name,
                                                    const FeatureCache* cache) {
  return std::make_unique<DiffusionStage>(state, name, cache);
}

HeldOut encodeHeldOut(const TrainingState& state) {
  const at::NoGradGuard no_gradient;
  const BatchMaker batches(state.dataset, state.normalizer,
                           batchOptions(state, "held out", kImageBatch), state.run.device);
  HeldOut held_out{batches.plain(state.run.held_out, false), {}};
  std::vector<at::Tensor> features, previous, known;
  for (std::size_t begin = 0; begin < state.run.held_out.size(); begin += kEncodeBatch) {
    const std::size_t end = std::min(begin + kEncodeBatch, state.run.held_out.size());
    const TrainingBatch part =
        batches.plain({state.run.held_out.begin() + static_cast<std::ptrdiff_t>(begin),
                       state.run.held_out.begin() + static_cast<std::ptrdiff_t>(end)},
                      true);
    features.push_back(state.encoder.forward(part.images));
    if (!state.architecture.takesPrevious()) continue;
    previous.push_back(state.encoder.forward(part.previous_images));
    known.push_back(part.context.has_previous);
  }
  held_out.batch.context.features = at::cat(features);
  if (!previous.empty()) {
    held_out.batch.context.previous = at::cat(previous);
    held_out.batch.context.has_previous = at::cat(known);
  }
  traffic::CameraImage gray;
  gray.width = static_cast<int>(state.architecture.image_width);
  gray.height = static_cast<int>(state.architecture.image_height);
  gray.rgb.assign(static_cast<std::size_t>(gray.width * gray.height * 3), 128);
  held_out.gray_features =
      state.encoder.forward(learning::imageTensor({&gray}, 1.0, state.run.device));
  return held_out;
}

}  // namespace cdiff::planners
