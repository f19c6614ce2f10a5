// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// A model of a given architecture with fixed random weights: it plans nonsense, but always the
/// same.
#pragma once

#include <cmath>
#include <filesystem>

#include "diffusion/model.h"
#include "support/tensors.h"

namespace cdiff::testing {

/// He-scaled weights; gains of normalizations 1, their biases 0.
inline std::map<std::string, inference::Tensor> randomTensors(
    const std::vector<inference::TensorShape>& shapes) {
  const core::RandomStream random(1, "random model");
  std::map<std::string, inference::Tensor> tensors;
  for (const inference::TensorShape& shape : shapes) {
    std::int64_t fan_in = 1;
    for (std::size_t axis = 1; axis < shape.shape.size(); ++axis) fan_in *= shape.shape[axis];
    const bool vector = shape.shape.size() == 1;
    const bool gain =
        shape.name.find("norm") != std::string::npos && shape.name.back() == 't';  // "...weight"
    const double scale = vector ? 0.1 : std::sqrt(2.0 / static_cast<double>(fan_in));
    tensors[shape.name] = test::tensorOf(shape.shape, [&](std::uint32_t i) {
      return gain ? 1.0 : random.normal({core::hashText(shape.name), 0, 0}, i) * scale;
    });
  }
  return tensors;
}

/// Without the encoder, whose 21 million weights take a second. Positions up to 20 m ahead, actions
/// centered in their range.
inline diffusion::Model randomDenoiser(const diffusion::Architecture& architecture = {}) {
  diffusion::Model model;
  model.name = "random";
  model.architecture = architecture;
  const Eigen::Index horizon = architecture.horizon;
  model.normalizer.mean = traffic::Rollout::Zero(horizon, traffic::kRolloutColumns);
  model.normalizer.scale = traffic::Rollout::Constant(horizon, traffic::kRolloutColumns, 0.5);
  model.normalizer.scale.leftCols<2>().setConstant(5.0);
  model.normalizer.mean.col(traffic::kRolloutThrottle).setConstant(0.5);
  model.normalizer.mean.col(traffic::kRolloutBrake).setConstant(0.5);
  model.spread = traffic::Rollout::Constant(horizon, traffic::kRolloutColumns, 0.3);
  model.denoiser = randomTensors(diffusion::denoiserTensors(architecture));
  return model;
}

inline diffusion::Model randomModel(const diffusion::Architecture& architecture = {}) {
  diffusion::Model model = randomDenoiser(architecture);
  model.encoder = randomTensors(diffusion::encoderTensors(architecture));
  return model;
}

/// The random model as files in `folder`, for planners that read it.
inline std::string writeRandomModel(const std::filesystem::path& folder,
                                    const diffusion::Architecture& architecture = {}) {
  std::filesystem::create_directories(folder);
  diffusion::saveModel(cdiff::testing::randomModel(architecture), folder,
                       inference::TensorType::kF16, {});
  return folder.string();
}

}  // namespace cdiff::testing
