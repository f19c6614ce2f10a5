// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// A model of a given architecture with fixed random weights: it plans nonsense, but always the
/// same.
#pragma once

#include <cmath>
#include <filesystem>

#include "diffusion/model.h"
#include "e2e_cdiff/core/random.h"

namespace cdiff::testing {

/// He-scaled weights; gains of normalizations 1, their biases 0.
inline std::map<std::string, inference::Tensor> randomTensors(
    const std::vector<inference::TensorShape>& shapes) {
  const core::RandomStream random(1, "random model");
  std::map<std::string, inference::Tensor> tensors;
  for (const inference::TensorShape& shape : shapes) {
    std::size_t count = 1;
    for (const std::int64_t size : shape.shape) count *= static_cast<std::size_t>(size);
    const double fan_in = shape.shape.size() > 1
                              ? static_cast<double>(count) / static_cast<double>(shape.shape[0])
                              : 1.0;
    inference::Tensor tensor{shape.shape, {}};
    const bool norm = shape.name.find("norm") != std::string::npos;
    const bool vector = shape.shape.size() == 1;
    for (std::size_t i = 0; i < count; ++i) {
      const double draw =
          random.normal({core::hashText(shape.name), 0, 0}, static_cast<std::uint32_t>(i));
      const bool gain = norm && shape.name.back() == 't';  // "...weight"
      tensor.values.push_back(static_cast<float>(gain     ? 1.0
                                                 : vector ? 0.1 * draw
                                                          : draw * std::sqrt(2.0 / fan_in)));
    }
    tensors.emplace(shape.name, std::move(tensor));
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
