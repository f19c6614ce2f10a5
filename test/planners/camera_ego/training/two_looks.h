// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Random images of two looks of one ego, half a second apart, for networks at run time and with
/// gradients.
#pragma once

#include <memory>
#include <vector>

#include "e2e_cdiff/core/random.h"
#include "learning/batches.h"
#include "learning/parameters.h"
#include "planners/camera_ego/bev_encoder.h"
#include "planners/camera_ego/training/bev_trainer_network.h"

namespace cdiff::planners::testing {

inline traffic::CameraImage noise(std::uint64_t number) {
  const core::RandomStream random(4, "noise");
  traffic::CameraImage image{160, 96, 0, {}};
  for (std::uint32_t i = 0; i < 160 * 96 * 3; ++i)
    image.rgb.push_back(static_cast<std::uint8_t>(random.index({number}, i, 256)));
  return image;
}

/// Two looks of one ego, of which the second one reads the BEV of the first.
struct TwoLooks {
  std::vector<traffic::CameraImage> images;
  EgoPoses before{{{0.0, 0.0}, 0.0}, std::nullopt};
  EgoPoses now{{{3.7, 0.4}, 0.12}, geometry::Pose2d{{0.0, 0.0}, 0.0}};
  EgoMotion first = egoMotion(6.0, 0.1, before);
  EgoMotion second = egoMotion(7.0, 0.2, now);

  TwoLooks() {
    for (std::uint64_t i = 0; i < 6; ++i) images.push_back(noise(i));
  }
  /// Of the network; what it reads of the past is the caller's.
  template <class Input>
  Input input(bool present) const {
    Input input;
    for (std::size_t i = 0; i < 3; ++i)
      input.images.push_back(images[i + (present ? 3 : 0)].rgb.data());
    input.motion = present ? second : first;
    input.poses = present ? now : before;
    return input;
  }
  BevBatch batch(const BevGrid& bev, bool present) const {
    BevBatch batch;
    std::vector<const traffic::CameraImage*> views;
    for (std::size_t i = 0; i < 3; ++i) views.push_back(&images[i + (present ? 3 : 0)]);
    batch.images = learning::imageTensor(views, 1.0, at::kCPU);
    const EgoMotion& motion = present ? second : first;
    batch.motion =
        learning::toTensor({motion.begin(), motion.end()}, {1, kEgoMotionNumbers}, at::kCPU);
    const EgoPoses& poses = present ? now : before;
    batch.temporal = {std::make_shared<inference::SamplingPlan>(
        temporalPlan(bev, poses.present, poses.past.value_or(poses.present)))};
    batch.has_past = at::full({1, 1, 1}, present ? 1.0 : 0.0);
    return batch;
  }
};

}  // namespace cdiff::planners::testing
