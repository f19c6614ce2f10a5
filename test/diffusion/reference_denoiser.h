// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The denoiser of docs/neural_network.md, slow and in double, straight from the page; and random
/// models to compare with.
#pragma once

#include <vector>

#include "diffusion/denoiser.h"
#include "diffusion/model.h"

namespace cdiff::diffusion {

using Doubles = std::vector<double>;

/// [channels, rows], as the page draws it.
struct Grid {
  std::int64_t channels = 0;
  std::int64_t rows = 0;
  Doubles values;

  Grid(std::int64_t channels_in, std::int64_t rows_in)
      : channels(channels_in),
        rows(rows_in),
        values(static_cast<std::size_t>(channels_in * rows_in), 0.0) {}
  double& at(std::int64_t c, std::int64_t t) {
    return values[static_cast<std::size_t>(c * rows + t)];
  }
  double at(std::int64_t c, std::int64_t t) const {
    return values[static_cast<std::size_t>(c * rows + t)];
  }
};

double referenceMish(double x);
Grid referenceConvolution(const Grid& input, const inference::Tensor& weight,
                          const inference::Tensor& bias, std::int64_t stride, std::int64_t padding);
Grid referenceTransposedConvolution(const Grid& input, const inference::Tensor& weight,
                                    const inference::Tensor& bias, std::int64_t stride,
                                    std::int64_t padding);
Grid referenceGroupNorm(const Grid& input, std::int64_t groups, const inference::Tensor& weight,
                        const inference::Tensor& bias);

class ReferenceDenoiser {
 public:
  explicit ReferenceDenoiser(const Model& model) : model_(model) {}

  /// [T, 3] of noisy [T, 7], row-major.
  Doubles actions(const Doubles& noisy, int k, const Context& context) const;
  /// [T, 4] of actions [T, 3].
  Doubles states(const Doubles& actions, int k, const Context& context) const;

 private:
  const inference::Tensor& tensor(const std::string& name) const {
    return model_.denoiser.at(name);
  }
  Doubles linear(const std::string& name, const Doubles& input) const;
  Doubles timeEmbedding(int k) const;
  Doubles contextVector(const Context& context) const;
  Grid block(const std::string& name, const Grid& input) const;
  Grid residual(const std::string& name, const Grid& input, const Doubles& z) const;
  Grid pair(const std::string& name, const Grid& input, const Doubles& z) const;

  const Model& model_;
};

/// Weights of about unit gain, drawn from a named stream.
Model randomModel(const Architecture& architecture);
/// Sizes that fit no vector: channels are no multiples of 16.
Architecture smallArchitecture();
Context randomContext(const Architecture& architecture, std::uint32_t seed, bool with_route = true);
/// Standard normal.
std::vector<float> randomValues(std::int64_t count, std::uint32_t seed);

Doubles toDoubles(const std::vector<float>& values);
double dot(const Doubles& left, const Doubles& right);
/// Largest difference over the largest reference value.
double relativeError(const std::vector<float>& values, const Doubles& reference);

}  // namespace cdiff::diffusion
