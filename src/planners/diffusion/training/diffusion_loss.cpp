// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/diffusion/training/diffusion_loss.h"

#include <algorithm>
#include <cmath>

#include "learning/batches.h"
#include "learning/samples/driving_sample.h"
#include "learning/samples/sample_order.h"

namespace cdiff::planners {
namespace {

using learning::DrivingSample;
using learning::toTensor;

constexpr double kSpeedScale = 10.0;
constexpr std::uint32_t kMirrorDraw = 1000000;
constexpr std::uint32_t kRouteDraw = 1000001;
constexpr std::uint32_t kPreviousDraw = 1000002;
constexpr std::uint32_t kTargetDraw = 1000003;
// Dropped of the samples that keep their route; the others keep nothing but the image.
constexpr double kPreviousDrop = 0.125;
constexpr double kTargetDrop = 0.1;

/// Key of what is drawn for one place in the batch of a step.
core::RandomKey keyOf(std::int64_t step, std::size_t place) {
  return {place + 1, static_cast<std::uint32_t>(step)};
}

}  // namespace

bool mirroredInCache(std::size_t index) {
  return core::RandomStream(0, "mirrored features").uniform({index}, 0) < 0.5;
}

BatchMaker::BatchMaker(const learning::DrivingDataset& dataset,
                       const diffusion::Normalizer& normalizer, const BatchOptions& options,
                       const at::Device& device)
    : dataset_(dataset),
      normalizer_(normalizer),
      options_(options),
      device_(device),
      order_(dataset.training(),
             learning::balanceWeights(dataset, options.balance, options.yielding_share),
             options.batch, core::RandomStream(options.seed, options.stage + " order")),
      change_(options.seed, options.stage + " change"),
      noise_(options.seed, options.stage + " noise") {}

bool BatchMaker::isMirrored(std::size_t index, const core::RandomKey& key, bool cached) const {
  if (!options_.mirror) return false;
  return cached ? mirroredInCache(index) : change_.uniform(key, kMirrorDraw) < 0.5;
}

DrivingSample BatchMaker::changedSample(std::size_t index, const core::RandomKey& key,
                                        bool mirrored, bool with_image) const {
  DrivingSample sample = with_image ? dataset_.sample(index) : dataset_.withoutImage(index);
  if (mirrored) learning::mirrorSample(dataset_.schema(), sample);
  if (with_image && options_.change_light) learning::changeLight(change_, key, sample.image);
  if (with_image && options_.change_light)
    learning::changeLight(change_, key, sample.previous_image, 1);
  return sample;
}

TrainingBatch BatchMaker::training(std::int64_t step, const FeatureCache* cache) {
  const std::vector<std::size_t> indices = order_.at(step);
  std::vector<DrivingSample> samples;
  std::vector<float> has_route;
  std::vector<at::Tensor> features, previous, known;
  for (std::size_t place = 0; place < indices.size(); ++place) {
    const core::RandomKey key = keyOf(step, place);
    const bool mirrored = isMirrored(indices[place], key, cache != nullptr);
    samples.push_back(changedSample(indices[place], key, mirrored, cache == nullptr));
    has_route.push_back(change_.uniform(key, kRouteDraw) < options_.route_drop ? 0.0F : 1.0F);
    if (cache == nullptr) continue;
    const auto row = static_cast<std::int64_t>(indices[place]);
    features.push_back(cache->features[row]);
    if (!options_.with_motion) continue;
    previous.push_back(cache->previous[row]);
    known.push_back(cache->previous_known[row]);
  }
  TrainingBatch batch = pack(samples, has_route);
  batch.samples = indices;
  if (cache != nullptr) batch.context.features = at::stack(features).to(device_);
  if (!previous.empty()) {
    batch.context.previous = at::stack(previous).to(device_);
    batch.context.has_previous = at::stack(known).to(device_);
  }
  if (options_.with_motion) dropMotion(step, batch);
  addNoise(step, batch);
  return batch;
}

/// What a sample is not given at a step: without its route it is the image alone, else the image
/// before and the target speed are left out now and then.
void BatchMaker::dropMotion(std::int64_t step, TrainingBatch& batch) const {
  std::vector<float> keeps_previous, keeps_target;
  for (std::size_t place = 0; place < batch.samples.size(); ++place) {
    const core::RandomKey key = keyOf(step, place);
    keeps_previous.push_back(change_.uniform(key, kPreviousDraw) < kPreviousDrop ? 0.0F : 1.0F);
    keeps_target.push_back(change_.uniform(key, kTargetDraw) < kTargetDrop ? 0.0F : 1.0F);
  }
  const auto count = static_cast<std::int64_t>(batch.samples.size());
  ContextBatch& context = batch.context;
  context.has_previous =
      context.has_previous * context.has_route * toTensor(keeps_previous, {count, 1}, device_);
  context.has_target =
      context.has_target * context.has_route * toTensor(keeps_target, {count, 1}, device_);
}

void BatchMaker::packMotion(const std::vector<DrivingSample>& samples, TrainingBatch& batch) const {
  std::vector<float> targets, has_target, has_previous;
  std::vector<const traffic::CameraImage*> images;
  traffic::CameraImage black = samples.front().image;
  black.rgb.assign(black.rgb.size(), 0);
  for (const DrivingSample& sample : samples) {
    const bool known = std::isfinite(sample.target_speed);
    targets.push_back(known ? static_cast<float>(sample.target_speed / kSpeedScale) : 0.0F);
    has_target.push_back(known ? 1.0F : 0.0F);
    has_previous.push_back(sample.previous_image.empty() ? 0.0F : 1.0F);
    images.push_back(sample.previous_image.empty() ? &black : &sample.previous_image);
  }
  const auto count = static_cast<std::int64_t>(samples.size());
  batch.context.target = toTensor(targets, {count, 1}, device_);
  batch.context.has_target = toTensor(has_target, {count, 1}, device_);
  batch.context.has_previous = toTensor(has_previous, {count, 1}, device_);
  if (!black.rgb.empty())
    batch.previous_images = learning::imageTensor(images, options_.image_scale, device_);
}

TrainingBatch BatchMaker::plain(const std::vector<std::size_t>& indices, bool with_images) const {
  std::vector<DrivingSample> samples;
  samples.reserve(indices.size());
  for (const std::size_t index : indices)
    samples.push_back(with_images ? dataset_.sample(index) : dataset_.withoutImage(index));
  TrainingBatch batch = pack(samples, std::vector<float>(samples.size(), 1.0F));
  batch.samples = indices;
  return batch;
}

TrainingBatch BatchMaker::pack(const std::vector<DrivingSample>& samples,
                               const std::vector<float>& has_route) const {
  std::vector<float> rollouts, routes, speeds, targets, known;
  std::vector<std::uint8_t> maneuvers;
  std::vector<const traffic::CameraImage*> images;
  for (const DrivingSample& sample : samples) {
    const diffusion::Trajectory normalized = normalizer_.normalize(sample.rollout);
    rollouts.insert(rollouts.end(), normalized.data(), normalized.data() + normalized.size());
    routes.insert(routes.end(), sample.route.begin(), sample.route.end());
    speeds.push_back(static_cast<float>(sample.speed / kSpeedScale));
    maneuvers.push_back(sample.maneuver);
    for (const float value : sample.auxiliary) {
      known.push_back(std::isfinite(value) ? 1.0F : 0.0F);
      targets.push_back(std::isfinite(value) ? value : 0.0F);
    }
    if (!sample.image.empty()) images.push_back(&sample.image);
  }
  const learning::DrivingSchema& schema = dataset_.schema();
  const auto count = static_cast<std::int64_t>(samples.size());
  const auto auxiliary = static_cast<std::int64_t>(schema.auxiliary.size());
  TrainingBatch batch;
  batch.maneuvers = std::move(maneuvers);
  batch.rollouts = toTensor(rollouts, {count, schema.horizon, traffic::kRolloutColumns}, device_);
  batch.context.route = toTensor(routes, {count, 2 * schema.route_points}, device_);
  batch.context.has_route = toTensor(has_route, {count, 1}, device_);
  batch.context.speed = toTensor(speeds, {count, 1}, device_);
  batch.auxiliary = toTensor(targets, {count, auxiliary}, device_);
  batch.auxiliary_known = toTensor(known, {count, auxiliary}, device_);
  if (!images.empty()) batch.images = learning::imageTensor(images, options_.image_scale, device_);
  if (options_.with_motion) packMotion(samples, batch);
  return batch;
}

void BatchMaker::addNoise(std::int64_t step, TrainingBatch& batch) const {
  const core::RandomKey key{0, static_cast<std::uint32_t>(step)};
  const std::int64_t count = batch.rollouts.size(0);
  at::Tensor k = at::empty({count}, at::kLong);
  for (std::int64_t i = 0; i < count; ++i) {
    k.data_ptr<std::int64_t>()[i] = 1 + static_cast<std::int64_t>(change_.index(
                                            key, static_cast<std::uint32_t>(i),
                                            static_cast<std::size_t>(options_.diffusion_steps)));
  }
  std::vector<float> noise(static_cast<std::size_t>(batch.rollouts.numel()));
  for (std::size_t i = 0; i < noise.size(); ++i)
    noise[i] = static_cast<float>(noise_.normal(key, static_cast<std::uint32_t>(i)));
  batch.k = k.to(device_);
  batch.noise = toTensor(noise, batch.rollouts.sizes(), device_);
}

namespace {

using learning::Loss;
using learning::Measures;
using learning::toIndices;
using learning::toVector;

constexpr std::int64_t kMeasuredSteps = 10;
/// Least spread, so that a proximal step stays possible everywhere.
constexpr double kLeastSpread = 1e-3;

at::Tensor states(const at::Tensor& rollouts) {
  return rollouts.narrow(2, 0, traffic::kStateColumns);
}

at::Tensor actions(const at::Tensor& rollouts) {
  return rollouts.narrow(2, traffic::kRolloutThrottle, traffic::kActionColumns);
}

/// w_t of the weighted loss.
float rowWeight(std::int64_t t) {
  return static_cast<float>(1.0 + 4.0 * std::exp(-static_cast<double>(t) / 4.0));
}

at::Tensor steps(std::int64_t count, std::int64_t k, const at::Device& device) {
  return at::full({count}, k, at::TensorOptions(device).dtype(at::kLong));
}

}  // namespace

DiffusionLoss::DiffusionLoss(Kind kind, const diffusion::Architecture& architecture,
                             const diffusion::Normalizer& normalizer, const at::Device& device)
    : kind_(kind),
      architecture_(architecture),
      schedule_(static_cast<int>(architecture.diffusion_steps)),
      device_(device) {
  std::vector<float> signal, noise, weights;
  for (int k = 0; k <= schedule_.steps(); ++k) {
    signal.push_back(static_cast<float>(std::sqrt(schedule_.alphaBar(k))));
    noise.push_back(static_cast<float>(std::sqrt(1.0 - schedule_.alphaBar(k))));
  }
  for (std::int64_t t = 0; t < architecture.horizon; ++t)
    weights.push_back(kind == Kind::kPlain ? 1.0F : rowWeight(t));
  signal_ = toTensor(signal, {schedule_.steps() + 1}, device);
  noise_ = toTensor(noise, {schedule_.steps() + 1}, device);
  weights_ = toTensor(weights, {1, architecture.horizon, 1}, device);
  const auto cells = [&](const traffic::Rollout& metric) {
    const diffusion::Trajectory plain = metric.cast<float>();
    return toTensor({plain.data(), plain.data() + plain.size()},
                    {architecture.horizon, traffic::kRolloutColumns}, device);
  };
  mean_ = cells(normalizer.mean);
  scale_ = cells(normalizer.scale);
}

at::Tensor DiffusionLoss::addNoise(const at::Tensor& clean, const at::Tensor& k,
                                   const at::Tensor& noise) const {
  return signal_.index_select(0, k).view({-1, 1, 1}) * clean +
         noise_.index_select(0, k).view({-1, 1, 1}) * noise;
}

Loss DiffusionLoss::loss(const DenoiserNet& denoiser, const TrainingBatch& batch) const {
  const at::Tensor noisy = addNoise(batch.rollouts, batch.k, batch.noise);
  const at::Tensor predicted = denoiser.predictActions(noisy, batch.k, batch.context);
  const at::Tensor predicted_states =
      denoiser.predictStates(predicted, batch.k, batch.context, true);
  const at::Tensor action_loss = (weights_ * (predicted - actions(batch.rollouts)).pow(2)).mean();
  const at::Tensor state_loss = (predicted_states - states(batch.rollouts)).pow(2).mean();
  at::Tensor total = action_loss + state_loss;
  if (kind_ == Kind::kPlain) {
    total = (action_loss * static_cast<double>(traffic::kActionColumns) +
             state_loss * static_cast<double>(traffic::kStateColumns)) /
            static_cast<double>(traffic::kRolloutColumns);
  }
  return {total, {{"actions", action_loss}, {"states", state_loss}}};
}

at::Tensor DiffusionLoss::predictClean(const DenoiserNet& denoiser, const at::Tensor& noisy,
                                       std::int64_t k, const ContextBatch& context) const {
  const at::Tensor all_k = steps(noisy.size(0), k, device_);
  const at::Tensor predicted = denoiser.predictActions(noisy, all_k, context);
  return at::cat({denoiser.predictStates(predicted, all_k, context, false), predicted}, 2);
}

at::Tensor DiffusionLoss::sample(const DenoiserNet& denoiser, const at::Tensor& noise,
                                 const ContextBatch& context, std::int64_t count) const {
  const std::int64_t last = schedule_.steps();
  at::Tensor noisy = noise;
  for (std::int64_t i = 0; i < count; ++i) {
    const std::int64_t k = last - i * last / count;
    const std::int64_t next = last - (i + 1) * last / count;
    const at::Tensor clean = predictClean(denoiser, noisy, k, context);
    const double now = schedule_.alphaBar(static_cast<int>(k));
    const double then = schedule_.alphaBar(static_cast<int>(next));
    const at::Tensor rest = (noisy - clean * std::sqrt(now)) / std::sqrt(1.0 - now);
    noisy = clean * std::sqrt(then) + rest * std::sqrt(1.0 - then);
  }
  return noisy;
}

at::Tensor DiffusionLoss::distances(const at::Tensor& predicted, const at::Tensor& clean) const {
  const at::Tensor error = (predicted - clean) * scale_;
  return (error.select(2, traffic::kRolloutX).pow(2) + error.select(2, traffic::kRolloutY).pow(2))
      .sqrt();
}

void DiffusionLoss::addMeasures(const std::string& prefix, const at::Tensor& predicted,
                                const at::Tensor& clean, Measures& measures) const {
  const at::Tensor error = ((predicted - clean) * scale_).abs();
  const at::Tensor distance = distances(predicted, clean);
  const auto mean = [&](int column) { return error.select(2, column).mean().item<double>(); };
  measures[prefix + "ade_m"] = distance.mean().item<double>();
  measures[prefix + "fde_m"] = distance.select(1, architecture_.horizon - 1).mean().item<double>();
  measures[prefix + "heading_rad"] = mean(traffic::kRolloutHeading);
  measures[prefix + "speed_mps"] = mean(traffic::kRolloutSpeed);
  measures[prefix + "throttle"] = mean(traffic::kRolloutThrottle);
  measures[prefix + "steer"] = mean(traffic::kRolloutSteer);
  measures[prefix + "brake"] = mean(traffic::kRolloutBrake);
}

namespace {

ContextBatch withoutTarget(ContextBatch context) {
  context.has_target = at::zeros_like(context.has_route);
  return context;
}

}  // namespace

at::Tensor DiffusionLoss::fixedNoise(const at::Tensor& like, const std::string& name) const {
  const core::RandomStream stream(0, name);
  std::vector<float> values(static_cast<std::size_t>(like.numel()));
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = static_cast<float>(stream.normal({}, static_cast<std::uint32_t>(i)));
  return toTensor(values, like.sizes(), device_);
}

Measures DiffusionLoss::measureHeldOut(const DenoiserNet& denoiser, const TrainingBatch& held_out,
                                       const at::Tensor& gray_features) const {
  const at::NoGradGuard no_gradient;
  const at::Tensor& clean = held_out.rollouts;
  const at::Tensor noise = fixedNoise(clean, "validation noise");
  Measures measures;
  const std::int64_t last = schedule_.steps();
  for (const auto& [prefix, k] :
       {std::pair<std::string, std::int64_t>{"one_step_half_", (last + 1) / 2},
        {"one_step_noise_", last}}) {
    const at::Tensor noisy = addNoise(clean, steps(clean.size(0), k, device_), noise);
    addMeasures(prefix, predictClean(denoiser, noisy, k, held_out.context), clean, measures);
  }
  const std::int64_t count = std::min(kMeasuredSteps, last);
  addMeasures("sample_", sample(denoiser, noise, held_out.context, count), clean, measures);
  ContextBatch context = held_out.context;
  context.has_route = at::zeros_like(context.has_route);
  addMeasures("sample_no_route_", sample(denoiser, noise, context, count), clean, measures);
  if (architecture_.takesPrevious()) {
    context.has_previous = at::zeros_like(context.has_route);
    addMeasures("sample_image_alone_", sample(denoiser, noise, withoutTarget(context), count),
                clean, measures);
    ContextBatch one_image = held_out.context;
    one_image.has_previous = context.has_previous;
    addMeasures("sample_one_image_", sample(denoiser, noise, one_image, count), clean, measures);
    addMeasures("sample_no_target_",
                sample(denoiser, noise, withoutTarget(held_out.context), count), clean, measures);
  }
  context.features = gray_features.view({1, -1}).expand_as(context.features).contiguous();
  addMeasures("sample_grey_no_route_", sample(denoiser, noise, context, count), clean, measures);
  context.has_route = held_out.context.has_route;
  addMeasures("sample_grey_", sample(denoiser, noise, context, count), clean, measures);
  return measures;
}

at::Tensor DiffusionLoss::constantVelocity(const TrainingBatch& batch) const {
  const at::Tensor metric = at::zeros_like(batch.rollouts);
  const at::Tensor speed = batch.context.speed * kSpeedScale;  // [B, 1]
  const at::Tensor time =
      at::arange(1, architecture_.horizon + 1, batch.rollouts.options()) * traffic::kRolloutStep;
  metric.select(2, traffic::kRolloutX).copy_(speed * time);
  metric.select(2, traffic::kRolloutSpeed).copy_(speed.expand({-1, architecture_.horizon}));
  return (metric - mean_) / scale_;
}

Measures DiffusionLoss::measureFurther(const DenoiserNet& denoiser,
                                       const TrainingBatch& held_out) const {
  const at::NoGradGuard no_gradient;
  const at::Tensor& clean = held_out.rollouts;
  const std::int64_t count = std::min<std::int64_t>(kMeasuredSteps, schedule_.steps());
  Measures measures;
  addMeasures("constant_velocity_", constantVelocity(held_out), clean, measures);
  for (const char* action : {"throttle", "steer", "brake"})
    measures.erase(std::string("constant_velocity_") + action);
  std::vector<at::Tensor> averages, ends;
  for (int i = 0; i < kManySamples; ++i) {
    const at::Tensor noise = fixedNoise(clean, "card noise " + std::to_string(i));
    const at::Tensor distance = distances(sample(denoiser, noise, held_out.context, count), clean);
    averages.push_back(distance.mean(1));
    ends.push_back(distance.select(1, architecture_.horizon - 1));
  }
  measures["least_of_8_ade_m"] = at::stack(averages).amin(0).mean().item<double>();
  measures["least_of_8_fde_m"] = at::stack(ends).amin(0).mean().item<double>();
  const at::Tensor sampled =
      sample(denoiser, fixedNoise(clean, "validation noise"), held_out.context, count);
  for (std::size_t maneuver = 0; maneuver < learning::kManeuvers.size(); ++maneuver) {
    std::vector<std::int64_t> rows;
    for (std::size_t i = 0; i < held_out.maneuvers.size(); ++i)
      if (held_out.maneuvers[i] == maneuver) rows.push_back(static_cast<std::int64_t>(i));
    if (rows.empty()) continue;
    const at::Tensor at_rows = toIndices(rows, {static_cast<std::int64_t>(rows.size())}, device_);
    const std::string prefix = std::string("sample_") + learning::kManeuvers[maneuver] + "_";
    addMeasures(prefix, sampled.index_select(0, at_rows), clean.index_select(0, at_rows), measures);
    measures[prefix + "samples"] = static_cast<double>(rows.size());
  }
  return measures;
}

traffic::Rollout DiffusionLoss::spread(const DenoiserNet& denoiser,
                                       const TrainingBatch& held_out) const {
  const at::NoGradGuard no_gradient;
  const at::Tensor& clean = held_out.rollouts;
  const std::int64_t last = schedule_.steps();
  const at::Tensor noisy =
      addNoise(clean, steps(clean.size(0), last, device_), fixedNoise(clean, "spread noise"));
  const at::Tensor error = predictClean(denoiser, noisy, last, held_out.context) - clean;
  const std::vector<float> deviation = toVector(error.pow(2).mean(0).sqrt());
  traffic::Rollout spread(architecture_.horizon, traffic::kRolloutColumns);
  for (Eigen::Index i = 0; i < spread.size(); ++i)
    spread.data()[i] =
        std::max(kLeastSpread, static_cast<double>(deviation[static_cast<std::size_t>(i)]));
  return spread;
}

}  // namespace cdiff::planners
