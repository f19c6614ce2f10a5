// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cmath>

#include "diffusion/network/cpu_denoiser.h"
#include "diffusion/reference_denoiser.h"
#include "inference/unet_layers.h"

namespace cdiff::diffusion {
namespace {

constexpr std::int64_t kHalo = 2;

class DenoiserLayers : public testing::TestWithParam<CpuDenoiser::InstructionSet> {
 protected:
  void SetUp() override {
    if (GetParam() > CpuDenoiser::bestInstructionSet()) {
      GTEST_SKIP() << "this CPU lacks " << CpuDenoiser::toText(GetParam());
    }
  }
  const inference::DenoiserKernels& kernels() const {
    if (GetParam() == CpuDenoiser::InstructionSet::kPlain) return *inference::plainKernels();
    return GetParam() == CpuDenoiser::InstructionSet::kAvx2 ? *inference::avx2Kernels()
                                                            : *inference::avx512Kernels();
  }
};

inference::Tensor randomTensor(const std::vector<std::int64_t>& shape, std::uint32_t seed) {
  std::int64_t count = 1;
  for (const std::int64_t size : shape) count *= size;
  return {shape, randomValues(count, seed)};
}

Grid randomGrid(std::int64_t channels, std::int64_t rows, std::uint32_t seed) {
  Grid grid(channels, rows);
  grid.values = toDoubles(randomValues(channels * rows, seed));
  return grid;
}

/// Channels first in double to channels last and padded in float, and back.
inference::Activation activationOf(const Grid& grid, const inference::ChannelLayout& layout) {
  inference::Activation result(layout, grid.rows, kHalo);
  result.resize(1);
  for (std::int64_t c = 0; c < grid.channels; ++c) {
    for (std::int64_t t = 0; t < grid.rows; ++t) {
      result.view().data[t * result.channels() + layout.place(c)] =
          static_cast<float>(grid.at(c, t));
    }
  }
  return result;
}

std::vector<float> valuesOf(const inference::Activation& activation,
                            const inference::ChannelLayout& layout) {
  std::vector<float> result;
  for (std::int64_t c = 0; c < layout.channels; ++c) {
    for (std::int64_t t = 0; t < activation.rows(); ++t) {
      result.push_back(activation.view().data[t * activation.channels() + layout.place(c)]);
    }
  }
  return result;
}

inference::Activation emptyActivation(const inference::ChannelLayout& layout, std::int64_t rows) {
  return activationOf(Grid(layout.channels, rows), layout);
}

/// Compares a convolution with the reference's `expected` and its reverse by <C x, y> = <x, C^T y>,
/// where C is the convolution without its bias.
void expectConvolution(const inference::DenoiserKernels& kernels, const inference::Filter& filter,
                       const inference::Spacing& spacing, const inference::Tensor& bias,
                       const Grid& input, const Grid& expected) {
  const inference::Activation x = activationOf(input, filter.inputs);
  inference::Activation output = emptyActivation(filter.outputs, expected.rows);
  inference::Convolution(kernels, filter, spacing, &bias)
      .apply(x.view(), output.view(), expected.rows);
  EXPECT_LT(relativeError(valuesOf(output, filter.outputs), expected.values), 1e-6);

  inference::Convolution(kernels, filter, spacing).apply(x.view(), output.view(), expected.rows);
  const Doubles linear = toDoubles(valuesOf(output, filter.outputs));
  const Grid y = randomGrid(expected.channels, expected.rows, 5);
  inference::Activation pulled = emptyActivation(filter.inputs, input.rows);
  inference::Convolution(kernels, filter.transposed(), spacing.reversed())
      .apply(activationOf(y, filter.outputs).view(), pulled.view(), input.rows);
  const Doubles back = toDoubles(valuesOf(pulled, filter.inputs));
  EXPECT_NEAR(dot(linear, y.values), dot(input.values, back),
              1e-6 * std::sqrt(dot(input.values, input.values) * dot(back, back)));
}

TEST_P(DenoiserLayers, ConvolutionsAgreeWithTheReference) {
  for (const std::int64_t outputs : {3, 20, 48}) {
    for (const std::int64_t kernel : {1, 3, 5}) {
      for (const std::int64_t stride : {1, 2}) {
        if (kernel != 3 && stride == 2) continue;
        const inference::Tensor weight = randomTensor({outputs, 6, kernel}, 1);
        const inference::Tensor bias = randomTensor({outputs}, 2);
        const Grid input = randomGrid(6, 20, 3);
        const Grid expected = referenceConvolution(input, weight, bias, stride, kernel / 2);
        inference::Filter filter = inference::Filter::ofConvolution(weight);
        expectConvolution(kernels(), filter, {stride, kernel / 2, false}, bias, input, expected);
        filter.inputs.parts = 2;  // the same channels, three by three
        expectConvolution(kernels(), filter, {stride, kernel / 2, false}, bias, input, expected);
      }
    }
  }
}

TEST_P(DenoiserLayers, TransposedConvolutionAgreesWithTheReference) {
  const inference::Tensor weight = randomTensor({6, 20, 4}, 1);
  const inference::Tensor bias = randomTensor({20}, 2);
  const Grid input = randomGrid(6, 10, 3);
  expectConvolution(kernels(), inference::Filter::ofTransposedConvolution(weight), {2, 1, true},
                    bias, input, referenceTransposedConvolution(input, weight, bias, 2, 1));
}

TEST_P(DenoiserLayers, AccumulatingConvolutionAddsToWhatIsThere) {
  // One input 2, one weight 3, on top of 10: 10 + 2 x 3 = 16; the bias does not count.
  const inference::Tensor weight{{1, 1, 1}, {3.0f}};
  const inference::Tensor bias{{1}, {100.0f}};
  inference::Activation input = inference::matrix(1, 1);
  inference::Activation output = inference::matrix(1, 1);
  *input.row(0) = 2.0f;
  *output.row(0) = 10.0f;
  inference::Convolution(kernels(), inference::Filter::ofConvolution(weight), inference::Spacing{},
                         &bias)
      .apply(input.view(), output.view(), 1, true);
  EXPECT_EQ(*output.row(0), 16.0f);
}

TEST_P(DenoiserLayers, MishAndItsSlopeAreAccurate) {
  for (double x = -80.0; x < 80.0; x += 0.37) {
    float input[inference::kChannelMultiple] = {static_cast<float>(x)};
    float value[inference::kChannelMultiple];
    float slope[inference::kChannelMultiple];
    kernels().mish(input, inference::kChannelMultiple, value, slope);
    const double given = static_cast<double>(input[0]);
    const double tangent = std::tanh(std::log1p(std::exp(given)));
    // (tanh s)' = (1 - tanh^2 s) s' with s = ln(1 + e^x), s' = e^x / (1 + e^x).
    const double cosine = std::cosh(std::log1p(std::exp(given)));
    const double bell = given / (1.0 + std::exp(-given)) / (cosine * cosine);
    EXPECT_NEAR(value[0], given * tangent, 1e-6 * std::abs(given * tangent)) << x;
    EXPECT_NEAR(slope[0], tangent + bell, 1e-6 * (tangent + std::abs(bell))) << x;
    EXPECT_EQ(value[1], 0.0f);  // Mish(0) = 0 keeps the padding
  }
}

TEST_P(DenoiserLayers, MishIsFiniteFarOut) {
  float input[inference::kChannelMultiple] = {1e4f, -1e4f, 1e30f};
  float value[inference::kChannelMultiple];
  float slope[inference::kChannelMultiple];
  kernels().mish(input, inference::kChannelMultiple, value, slope);
  EXPECT_EQ(value[0], 1e4f);
  EXPECT_EQ(slope[0], 1.0f);
  EXPECT_NEAR(value[1], 0.0f, 1e-30);
  EXPECT_NEAR(slope[1], 0.0f, 1e-30);
  EXPECT_EQ(value[2], 1e30f);
  EXPECT_EQ(slope[2], 1.0f);
}

TEST_P(DenoiserLayers, NormalizedConvolutionAgreesWithTheReference) {
  const std::int64_t rows = 9;
  const inference::Tensors tensors = {{"block.conv.weight", randomTensor({12, 5, 3}, 1)},
                                      {"block.conv.bias", randomTensor({12}, 2)},
                                      {"block.norm.weight", randomTensor({12}, 3)},
                                      {"block.norm.bias", randomTensor({12}, 4)}};
  const auto function = [&](const Grid& x) {
    Grid y = referenceGroupNorm(referenceConvolution(x, tensors.at("block.conv.weight"),
                                                     tensors.at("block.conv.bias"), 1, 1),
                                4, tensors.at("block.norm.weight"), tensors.at("block.norm.bias"));
    for (double& value : y.values) value = referenceMish(value) + 1.0;
    return y;
  };
  const inference::ChannelLayout inputs{5};
  const inference::ChannelLayout outputs{12};
  const Grid x = randomGrid(5, rows, 6);
  inference::NormalizedConvolution block({kernels(), tensors, 4, kHalo}, "block", inputs, rows);
  block.resize(1);
  inference::Activation ones = inference::matrix(16, 1);
  std::fill_n(ones.row(0), 16, 1.0f);
  inference::Activation y = emptyActivation(outputs, rows);
  block.forward(0, activationOf(x, inputs).view(), {ones.row(0), 0}, y.view());
  EXPECT_LT(relativeError(valuesOf(y, outputs), function(x).values), 1e-6);

  const Grid gradient = randomGrid(12, rows, 7);
  inference::Activation pulled = emptyActivation(inputs, rows);
  block.backward(0, activationOf(gradient, outputs).view(), pulled.view(), false);
  Doubles expected;
  for (std::size_t i = 0; i < x.values.size(); ++i) {
    Grid ahead = x;
    Grid behind = x;
    ahead.values[i] += 1e-5;
    behind.values[i] -= 1e-5;
    expected.push_back((dot(function(ahead).values, gradient.values) -
                        dot(function(behind).values, gradient.values)) /
                       2e-5);
  }
  EXPECT_LT(relativeError(valuesOf(pulled, inputs), expected), 1e-5);
}

INSTANTIATE_TEST_SUITE_P(InstructionSets, DenoiserLayers,
                         testing::Values(CpuDenoiser::InstructionSet::kPlain,
                                         CpuDenoiser::InstructionSet::kAvx2,
                                         CpuDenoiser::InstructionSet::kAvx512),
                         [](const auto& info) { return CpuDenoiser::toText(info.param); });

}  // namespace
}  // namespace cdiff::diffusion
