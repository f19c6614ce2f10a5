// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "learning/driving_changes.h"

#include <algorithm>
#include <cmath>

namespace cdiff::learning {
namespace {

bool endsInLeft(const std::string& name) {
  const std::string ending = "_left";
  return name.size() >= ending.size() &&
         name.compare(name.size() - ending.size(), ending.size(), ending) == 0;
}

}  // namespace

void mirrorRollout(traffic::Rollout& rollout) {
  for (const int column : {traffic::kRolloutY, traffic::kRolloutHeading, traffic::kRolloutSteer})
    rollout.col(column) *= -1.0;
}

void mirrorSample(const DrivingSchema& schema, DrivingSample& sample) {
  const int width = sample.image.width;
  for (std::size_t pixel = 0; pixel < sample.image.rgb.size() / 3; ++pixel) {
    const std::size_t column = pixel % static_cast<std::size_t>(width);
    const std::size_t other = pixel - column + static_cast<std::size_t>(width) - 1 - column;
    for (std::size_t c = 0; other > pixel && c < 3; ++c)
      std::swap(sample.image.rgb[3 * pixel + c], sample.image.rgb[3 * other + c]);
  }
  mirrorRollout(sample.rollout);
  for (std::size_t i = 1; i < sample.route.size(); i += 2) sample.route[i] *= -1.0F;
  for (std::size_t i = 0; i < sample.auxiliary.size(); ++i) {
    if (endsInLeft(schema.auxiliary[i])) sample.auxiliary[i] *= -1.0F;
  }
}

void changeLight(const core::RandomStream& random, const core::RandomKey& key,
                 traffic::CameraImage& image) {
  const double brightness = random.uniform(key, 0, -40.0, 40.0);
  const double contrast = random.uniform(key, 1, 0.8, 1.2);
  const double noise = random.uniform(key, 2, 0.0, 12.0) / 127.5;
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < image.rgb.size(); ++i) {
    if (i % 8 == 0) bits = random.bits(key, static_cast<std::uint32_t>(3 + i / 8));
    const double jitter = noise * (static_cast<double>(bits & 255U) - 127.5);
    bits >>= 8;
    const double value =
        (static_cast<double>(image.rgb[i]) - 127.5) * contrast + 127.5 + brightness + jitter;
    image.rgb[i] = static_cast<std::uint8_t>(std::clamp(std::lround(value), 0L, 255L));
  }
}

}  // namespace cdiff::learning
