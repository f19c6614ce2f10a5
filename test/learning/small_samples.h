// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Small samples made by rule, for tests.
#pragma once

#include <unistd.h>

#include <filesystem>
#include <stdexcept>
#include <string>

#include "diffusion/network/architecture.h"
#include "e2e_cdiff/core/random.h"
#include "learning/samples/driving_sample.h"
#include "support/temporary_folder.h"

namespace cdiff::test {

inline learning::DrivingSchema smallSchema() {
  learning::DrivingSchema schema;
  schema.horizon = 8;
  schema.image_width = 64;
  schema.image_height = 64;
  schema.route_points = 4;
  return schema;
}

/// Sample `index` of session `session`: a vehicle that keeps its speed of 5 + index m/s straight
/// on; the image is gray noise with a bright column that encodes the index.
inline learning::DrivingSample smallSample(std::size_t index, std::uint64_t session) {
  const learning::DrivingSchema schema = smallSchema();
  const core::RandomStream noise(7, "test image");
  learning::DrivingSample sample;
  sample.image.width = static_cast<int>(schema.image_width);
  sample.image.height = static_cast<int>(schema.image_height);
  sample.image.rgb.resize(static_cast<std::size_t>(schema.image_width * schema.image_height * 3));
  for (std::size_t i = 0; i < sample.image.rgb.size(); ++i) {
    const bool bright = (i / 3) % 64 / 8 == index % 8;
    sample.image.rgb[i] = static_cast<std::uint8_t>(
        bright ? 255 : noise.index({index}, static_cast<std::uint32_t>(i), 128));
  }
  sample.speed = 5.0 + static_cast<double>(index);
  sample.rollout.setZero(schema.horizon, traffic::kRolloutColumns);
  for (Eigen::Index t = 0; t < schema.horizon; ++t) {
    sample.rollout(t, traffic::kRolloutX) = sample.speed * 0.1 * static_cast<double>(t + 1);
    sample.rollout(t, traffic::kRolloutSpeed) = sample.speed;
    sample.rollout(t, traffic::kRolloutThrottle) = 0.25;
    sample.rollout(t, traffic::kRolloutSteer) = index % 2 == 0 ? 0.5 : -0.5;
  }
  for (std::int64_t i = 0; i < schema.route_points; ++i) {
    sample.route.push_back(0.15F * static_cast<float>(i));
    sample.route.push_back(index % 2 == 0 ? 0.25F : -0.25F);
  }
  sample.session = session;
  sample.vehicle = "v" + std::to_string(index);
  sample.tick = 10 * index;
  sample.recovering = index % 2 == 1;
  sample.maneuver = static_cast<std::uint8_t>(index % 4);
  return sample;
}

/// Networks that fit the small samples (the image encoder stays what it is).
inline diffusion::Architecture smallArchitecture() {
  diffusion::Architecture architecture;
  architecture.horizon = 8;
  architecture.diffusion_steps = 10;
  architecture.channels = {8, 16, 16};
  architecture.groups = 4;
  architecture.time_width = 8;
  architecture.image_width = 64;
  architecture.image_height = 64;
  architecture.image_features = 16;
  architecture.route_points = 4;
  architecture.route_features = 8;
  architecture.speed_features = 4;
  architecture.context_width = 16;
  architecture.state_hidden = 32;
  return architecture;
}

/// Of samples with an image before and a target speed.
inline learning::DrivingSchema motionSchema() {
  learning::DrivingSchema schema = smallSchema();
  schema.previous_interval = 0.4;
  schema.target_speeds = true;
  return schema;
}

/// A small sample with both; every third lacks the image before, every fifth the target speed.
inline learning::DrivingSample motionSample(std::size_t index, std::uint64_t session) {
  learning::DrivingSample sample = smallSample(index, session);
  if (index % 3 != 2) sample.previous_image = smallSample(index + 1, session).image;
  if (index % 5 != 4) sample.target_speed = 6.0 + static_cast<double>(index);
  return sample;
}

/// The first `count` samples, all of session 1, as one shard.
inline void writeShard(const std::filesystem::path& path, std::size_t count,
                       const learning::DrivingSchema& schema = smallSchema()) {
  learning::DrivingShardWriter writer(schema);
  for (std::size_t i = 0; i < count; ++i)
    writer.append(schema.target_speeds ? motionSample(i, 1) : smallSample(i, 1));
  writer.write(path);
}

}  // namespace cdiff::test
