// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/diffusion/training/diffusion_batches.h"

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
  return sample;
}

TrainingBatch BatchMaker::training(std::int64_t step, const FeatureCache* cache) {
  const std::vector<std::size_t> indices = order_.at(step);
  std::vector<DrivingSample> samples;
  std::vector<float> has_route;
  std::vector<at::Tensor> features;
  for (std::size_t place = 0; place < indices.size(); ++place) {
    const core::RandomKey key = keyOf(step, place);
    const bool mirrored = isMirrored(indices[place], key, cache != nullptr);
    samples.push_back(changedSample(indices[place], key, mirrored, cache == nullptr));
    has_route.push_back(change_.uniform(key, kRouteDraw) < options_.route_drop ? 0.0F : 1.0F);
    if (cache == nullptr) continue;
    features.push_back(cache->features[static_cast<std::int64_t>(indices[place])]);
  }
  TrainingBatch batch = pack(samples, has_route);
  batch.samples = indices;
  if (cache != nullptr) batch.context.features = at::stack(features).to(device_);
  addNoise(step, batch);
  return batch;
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
  std::vector<const traffic::CameraImage*> images;
  for (const DrivingSample& sample : samples) {
    const diffusion::Trajectory normalised = normalizer_.normalize(sample.rollout);
    rollouts.insert(rollouts.end(), normalised.data(), normalised.data() + normalised.size());
    routes.insert(routes.end(), sample.route.begin(), sample.route.end());
    speeds.push_back(static_cast<float>(sample.speed / kSpeedScale));
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
  batch.rollouts = toTensor(rollouts, {count, schema.horizon, traffic::kRolloutColumns}, device_);
  batch.context.route = toTensor(routes, {count, 2 * schema.route_points}, device_);
  batch.context.has_route = toTensor(has_route, {count, 1}, device_);
  batch.context.speed = toTensor(speeds, {count, 1}, device_);
  batch.auxiliary = toTensor(targets, {count, auxiliary}, device_);
  batch.auxiliary_known = toTensor(known, {count, auxiliary}, device_);
  if (!images.empty()) batch.images = learning::imageTensor(images, options_.image_scale, device_);
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

}  // namespace cdiff::planners
