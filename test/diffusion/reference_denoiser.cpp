// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "diffusion/reference_denoiser.h"

#include <algorithm>
#include <cmath>

#include "e2e_cdiff/core/random.h"

namespace cdiff::diffusion {
namespace {

Doubles mishOf(Doubles values) {
  for (double& value : values) value = referenceMish(value);
  return values;
}

Grid mishOf(Grid grid) {
  grid.values = mishOf(std::move(grid.values));
  return grid;
}

Grid plus(Grid left, const Grid& right) {
  for (std::size_t i = 0; i < left.values.size(); ++i) left.values[i] += right.values[i];
  return left;
}

Grid joined(const Grid& left, const Grid& right) {
  Grid result(left.channels + right.channels, left.rows);
  std::copy(left.values.begin(), left.values.end(), result.values.begin());
  std::copy(right.values.begin(), right.values.end(),
            result.values.begin() + static_cast<std::ptrdiff_t>(left.values.size()));
  return result;
}

double valueAt(const inference::Tensor& tensor, std::int64_t index) {
  return static_cast<double>(tensor.values[static_cast<std::size_t>(index)]);
}

Grid biased(const inference::Tensor& bias, std::int64_t rows) {
  Grid result(bias.shape[0], rows);
  for (std::int64_t c = 0; c < result.channels; ++c) {
    for (std::int64_t t = 0; t < rows; ++t) result.at(c, t) = valueAt(bias, c);
  }
  return result;
}

Doubles& append(Doubles& to, const Doubles& values) {
  to.insert(to.end(), values.begin(), values.end());
  return to;
}

}  // namespace

double referenceMish(double x) { return x * std::tanh(std::log1p(std::exp(x))); }

Grid referenceConvolution(const Grid& input, const inference::Tensor& weight,
                          const inference::Tensor& bias, std::int64_t stride,
                          std::int64_t padding) {
  const std::int64_t kernel = weight.shape[2];
  Grid result = biased(bias, (input.rows + 2 * padding - kernel) / stride + 1);
  for (std::int64_t o = 0; o < result.channels; ++o) {
    for (std::int64_t i = 0; i < input.channels; ++i) {
      for (std::int64_t k = 0; k < kernel; ++k) {
        const double w = valueAt(weight, (o * input.channels + i) * kernel + k);
        for (std::int64_t s = 0; s < result.rows; ++s) {
          const std::int64_t t = stride * s + k - padding;
          if (t >= 0 && t < input.rows) result.at(o, s) += w * input.at(i, t);
        }
      }
    }
  }
  return result;
}

Grid referenceTransposedConvolution(const Grid& input, const inference::Tensor& weight,
                                    const inference::Tensor& bias, std::int64_t stride,
                                    std::int64_t padding) {
  const std::int64_t kernel = weight.shape[2];
  Grid result = biased(bias, (input.rows - 1) * stride + kernel - 2 * padding);
  for (std::int64_t i = 0; i < input.channels; ++i) {
    for (std::int64_t o = 0; o < result.channels; ++o) {
      for (std::int64_t k = 0; k < kernel; ++k) {
        const double w = valueAt(weight, (i * result.channels + o) * kernel + k);
        for (std::int64_t t = 0; t < input.rows; ++t) {
          const std::int64_t s = stride * t + k - padding;
          if (s >= 0 && s < result.rows) result.at(o, s) += w * input.at(i, t);
        }
      }
    }
  }
  return result;
}

Grid referenceGroupNorm(const Grid& input, std::int64_t groups, const inference::Tensor& weight,
                        const inference::Tensor& bias) {
  Grid result = input;
  const std::int64_t size = input.channels / groups;
  for (std::int64_t first = 0; first < input.channels; first += size) {
    const auto count = static_cast<double>(size * input.rows);
    const double* group = input.values.data() + first * input.rows;
    double mean = 0.0;
    double variance = 0.0;
    for (std::int64_t i = 0; i < size * input.rows; ++i) mean += group[i] / count;
    for (std::int64_t i = 0; i < size * input.rows; ++i) {
      variance += (group[i] - mean) * (group[i] - mean) / count;
    }
    for (std::int64_t c = first; c < first + size; ++c) {
      for (std::int64_t t = 0; t < input.rows; ++t) {
        result.at(c, t) =
            (input.at(c, t) - mean) / std::sqrt(variance + 1e-5) * valueAt(weight, c) +
            valueAt(bias, c);
      }
    }
  }
  return result;
}

Doubles ReferenceDenoiser::linear(const std::string& name, const Doubles& input) const {
  const inference::Tensor& weight = tensor(name + ".weight");
  const inference::Tensor& bias = tensor(name + ".bias");
  Doubles result(bias.values.begin(), bias.values.end());
  for (std::size_t o = 0; o < result.size(); ++o) {
    for (std::size_t i = 0; i < input.size(); ++i) {
      result[o] += static_cast<double>(weight.values[o * input.size() + i]) * input[i];
    }
  }
  return result;
}

Doubles ReferenceDenoiser::timeEmbedding(int k) const {
  const std::int64_t half = model_.architecture.time_width / 2;
  Doubles sines;
  Doubles cosines;
  for (std::int64_t i = 0; i < half; ++i) {
    const double w =
        std::exp(-std::log(10000.0) * static_cast<double>(i) / static_cast<double>(half - 1));
    sines.push_back(std::sin(k * w));
    cosines.push_back(std::cos(k * w));
  }
  return linear("time.2", mishOf(linear("time.0", append(sines, cosines))));
}

Doubles ReferenceDenoiser::contextVector(const Context& context) const {
  Doubles joined = toDoubles(context.image_features);
  append(joined, context.route.empty()
                     ? toDoubles(tensor("no_route").values)
                     : linear("route.2", mishOf(linear("route.0", toDoubles(context.route)))));
  append(joined, mishOf(linear("speed.0", {context.speed / 10.0})));
  return mishOf(linear("context.0", joined));
}

Grid ReferenceDenoiser::block(const std::string& name, const Grid& input) const {
  const Grid convolved =
      referenceConvolution(input, tensor(name + ".conv.weight"), tensor(name + ".conv.bias"), 1,
                           model_.architecture.kernel / 2);
  return mishOf(referenceGroupNorm(convolved, model_.architecture.groups,
                                   tensor(name + ".norm.weight"), tensor(name + ".norm.bias")));
}

Grid ReferenceDenoiser::residual(const std::string& name, const Grid& input,
                                 const Doubles& z) const {
  Grid h = block(name + ".block1", input);
  const Doubles injected = linear(name + ".inject", z);
  for (std::int64_t c = 0; c < h.channels; ++c) {
    for (std::int64_t t = 0; t < h.rows; ++t) h.at(c, t) += injected[static_cast<std::size_t>(c)];
  }
  h = block(name + ".block2", h);
  if (input.channels == h.channels) return plus(h, input);
  return plus(h, referenceConvolution(input, tensor(name + ".skip.weight"),
                                      tensor(name + ".skip.bias"), 1, 0));
}

Grid ReferenceDenoiser::pair(const std::string& name, const Grid& input, const Doubles& z) const {
  return residual(name + ".b", residual(name + ".a", input, z), z);
}

Doubles ReferenceDenoiser::actions(const Doubles& noisy, int k, const Context& context) const {
  const Architecture& a = model_.architecture;
  Doubles z = timeEmbedding(k);
  z = mishOf(append(z, contextVector(context)));
  Grid x(7, a.horizon);
  for (std::int64_t t = 0; t < a.horizon; ++t) {
    for (std::int64_t c = 0; c < 7; ++c) x.at(c, t) = noisy[static_cast<std::size_t>(7 * t + c)];
  }
  std::vector<Grid> skips;
  const std::size_t levels = a.channels.size();
  for (std::size_t l = 0; l < levels; ++l) {
    const std::string name = "down." + std::to_string(l);
    x = pair(name, x, z);
    skips.push_back(x);
    if (l + 1 == levels) break;
    x = referenceConvolution(x, tensor(name + ".sample.weight"), tensor(name + ".sample.bias"), 2,
                             1);
  }
  x = pair("middle", x, z);
  for (std::size_t j = 0; j + 1 < levels; ++j) {
    const std::string name = "up." + std::to_string(j);
    x = pair(name, joined(x, skips[levels - 1 - j]), z);
    x = referenceTransposedConvolution(x, tensor(name + ".sample.weight"),
                                       tensor(name + ".sample.bias"), 2, 1);
  }
  x = referenceConvolution(block("head.block", x), tensor("head.out.weight"),
                           tensor("head.out.bias"), 1, 0);
  Doubles result;
  for (std::int64_t t = 0; t < a.horizon; ++t) {
    for (std::int64_t c = 0; c < 3; ++c) result.push_back(x.at(c, t));
  }
  return result;
}

Doubles ReferenceDenoiser::states(const Doubles& actions, int k, const Context& context) const {
  Doubles input = actions;
  input.push_back(context.speed / 10.0);
  append(input, timeEmbedding(k));
  return linear("state.4", mishOf(linear("state.2", mishOf(linear("state.0", input)))));
}

Model randomModel(const Architecture& architecture) {
  Model model;
  model.architecture = architecture;
  const core::RandomStream random(7, "test_weights");
  for (const inference::TensorShape& shape : denoiserTensors(architecture)) {
    const bool bias = shape.shape.size() == 1;
    const bool scale = bias && shape.name.find(".weight") != std::string::npos;
    std::int64_t count = 1;
    for (const std::int64_t size : shape.shape) count *= size;
    const auto fan = static_cast<double>(bias ? 100 : count / shape.shape[0]);
    inference::Tensor tensor{shape.shape, {}};
    core::RandomKey key;
    key.vehicle = core::hashText(shape.name);
    for (std::int64_t i = 0; i < count; ++i) {
      const double draw = random.normal(key, static_cast<std::uint32_t>(i)) / std::sqrt(fan);
      tensor.values.push_back(static_cast<float>(scale ? 1.0 + draw : draw));
    }
    model.denoiser[shape.name] = std::move(tensor);
  }
  return model;
}

Architecture smallArchitecture() {
  Architecture result;
  result.horizon = 12;
  result.diffusion_steps = 5;
  result.channels = {8, 20, 36};
  result.kernel = 3;
  result.groups = 4;
  result.time_width = 6;
  result.image_features = 10;
  result.route_points = 3;
  result.route_features = 5;
  result.speed_features = 4;
  result.context_width = 7;
  result.state_hidden = 18;
  return result;
}

std::vector<float> randomValues(std::int64_t count, std::uint32_t seed) {
  const core::RandomStream random(seed, "test_values");
  std::vector<float> result;
  for (std::int64_t i = 0; i < count; ++i) {
    result.push_back(static_cast<float>(random.normal({}, static_cast<std::uint32_t>(i))));
  }
  return result;
}

Context randomContext(const Architecture& architecture, std::uint32_t seed, bool with_route) {
  Context context;
  context.image_features = randomValues(architecture.image_features, seed + 1000);
  if (with_route) context.route = randomValues(2 * architecture.route_points, seed + 2000);
  context.speed = 3.0 + seed;
  return context;
}

Doubles toDoubles(const std::vector<float>& values) {
  return Doubles(values.begin(), values.end());
}

double dot(const Doubles& left, const Doubles& right) {
  double sum = 0.0;
  for (std::size_t i = 0; i < left.size(); ++i) sum += left[i] * right[i];
  return sum;
}

double relativeError(const std::vector<float>& values, const Doubles& reference) {
  double difference = 0.0;
  double size = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    difference = std::max(difference, std::abs(static_cast<double>(values[i]) - reference[i]));
    size = std::max(size, std::abs(reference[i]));
  }
  return difference / size;
}

}  // namespace cdiff::diffusion
