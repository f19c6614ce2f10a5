// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "inference/encoder_layers.h"

namespace cdiff::inference {
namespace {

/// Normalizes channel c, pixel p of the value 1000 c + p^2 (32 channels of 2 x 3 pixels) in a
/// layout, and returns [channel, pixel].
std::vector<double> normalized(dnnl::memory::format_tag layout, bool residual,
                               EncoderNorm::Activation activation) {
  const MapShape shape{32, 2, 3};
  Tensor gain{{32}, std::vector<float>(32, 2.0F)};
  Tensor shift{{32}, {}};
  for (int c = 0; c < 32; ++c) shift.values.push_back(0.1F * static_cast<float>(c % 5));
  const ChannelBlocks blocks(shape, layout);
  const auto place = [&](std::int64_t c, std::int64_t p) {
    return static_cast<std::size_t>(c / blocks.width * blocks.block_stride +
                                    p * blocks.pixel_stride + c % blocks.width);
  };
  std::vector<float> map(192);
  std::vector<float> other(192, 0.5F);
  for (std::int64_t c = 0; c < 32; ++c)
    for (std::int64_t p = 0; p < 6; ++p) map[place(c, p)] = static_cast<float>(1000 * c + p * p);
  EncoderNorm(shape, layout, gain, shift)
      .run(map.data(), residual ? other.data() : nullptr, activation);
  std::vector<double> plain;
  for (std::int64_t c = 0; c < 32; ++c)
    for (std::int64_t p = 0; p < 6; ++p) plain.push_back(static_cast<double>(map[place(c, p)]));
  return plain;
}

TEST(EncoderNorm, NormalisesGroupsOf16ChannelsInEveryLayout) {
  using Tag = dnnl::memory::format_tag;
  // p^2 = 0, 1, 4, 9, 16, 25 has mean 55 / 6 and variance 979 / 6 - (55 / 6)^2 = 79.138889;
  // channels 0..15 have mean 7500 and variance 1000^2 (16^2 - 1) / 12 = 21.25e6. Both groups alike.
  const double mean = 7500.0 + 55.0 / 6.0;
  const double deviation = std::sqrt(21.25e6 + 79.138889 + 1e-5);
  for (const Tag layout : {Tag::nhwc, Tag::nChw8c, Tag::nChw16c}) {
    for (const bool residual : {false, true}) {
      for (const bool relu : {false, true}) {
        const std::vector<double> result =
            normalized(layout, residual,
                       relu ? EncoderNorm::Activation::kRelu : EncoderNorm::Activation::kNone);
        for (int c = 0; c < 32; ++c) {
          for (int p = 0; p < 6; ++p) {
            double expected = 2.0 * (1000.0 * (c % 16) + p * p - mean) / deviation + 0.1 * (c % 5) +
                              (residual ? 0.5 : 0.0);
            if (relu) expected = std::max(expected, 0.0);
            EXPECT_NEAR(result[static_cast<std::size_t>(6 * c + p)], expected, 1e-5)
                << "channel " << c << ", pixel " << p << ", layout " << static_cast<int>(layout);
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace cdiff::inference
