// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/camera_ego/training/ego_batch.h"

#include <algorithm>

#include "learning/batches.h"

namespace cdiff::planners {

BevBatch bevBatch(const std::vector<const EgoExample*>& examples, std::size_t back,
                  const BevGrid& bev, const at::Device& device) {
  std::vector<const traffic::CameraImage*> images;
  std::vector<float> motion, has_past;
  BevBatch batch;
  for (const EgoExample* example : examples) {
    const std::size_t last = example->looks.size() - 1;
    const EgoFrame& look = example->looks[last - std::min(last, back)];
    for (const traffic::CameraImage& image : look.images) images.push_back(&image);
    motion.insert(motion.end(), look.motion.begin(), look.motion.end());
    const bool past = back <= last && look.poses.past.has_value();
    has_past.push_back(past ? 1.0F : 0.0F);
    batch.temporal.push_back(std::make_shared<inference::SamplingPlan>(
        temporalPlan(bev, look.poses.present, past ? *look.poses.past : look.poses.present)));
  }
  const auto samples = static_cast<std::int64_t>(examples.size());
  batch.images = learning::imageTensor(images, 1.0, device);
  batch.motion = learning::toTensor(motion, {samples, kEgoMotionNumbers}, device);
  batch.has_past = learning::toTensor(has_past, {samples, 1, 1}, device);
  return batch;
}

at::Tensor encodeFrames(const BevNet& net, const std::vector<const EgoExample*>& examples,
                        const CameraEgoSizes& sizes, const at::Device& device) {
  std::size_t looks = 1;
  for (const EgoExample* example : examples) looks = std::max(looks, example->looks.size());
  if (!sizes.past_bev) looks = 1;
  at::Tensor past;
  for (std::size_t back = looks - 1; back > 0; --back) {
    const at::NoGradGuard no_gradient;
    past = net.encode(bevBatch(examples, back, sizes.bev, device), past);
  }
  return net.encode(bevBatch(examples, 0, sizes.bev, device), past);
}

}  // namespace cdiff::planners
