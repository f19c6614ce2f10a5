// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include "e2e_cdiff/core/exceptions.h"
#include "inference/encoder_layers.h"

namespace cdiff::inference {
namespace {

/// Values that need all bits of a float, [count].
std::vector<float> values(std::int64_t count, float reach) {
  std::vector<float> made;
  for (std::int64_t i = 0; i < count; ++i)
    made.push_back(reach * static_cast<float>(std::sin(0.7 * static_cast<double>(i * i))));
  return made;
}

class EncoderKernelsOf : public ::testing::TestWithParam<InstructionSet> {
 protected:
  void SetUp() override {
    if (GetParam() > bestInstructionSet()) GTEST_SKIP() << "this CPU lacks " << toText(GetParam());
  }
};
INSTANTIATE_TEST_SUITE_P(InstructionSets, EncoderKernelsOf,
                         ::testing::Values(InstructionSet::kPlain, InstructionSet::kAvx2,
                                           InstructionSet::kAvx512),
                         [](const auto& info) { return toText(info.param); });

TEST_P(EncoderKernelsOf, NormalizeToTheBytesOfThePlainOnes) {
  const MapShape shape{64, 9, 11};  // 99 pixels: 64 are summed in float, then 35
  Tensor gain{{64}, values(64, 1.5F)};
  Tensor shift{{64}, values(64, 0.5F)};
  for (const auto layout : {dnnl::memory::format_tag::nhwc, dnnl::memory::format_tag::nChw8c}) {
    std::vector<float> expected = values(shape.size(), 3.0F);
    std::vector<float> map = expected;
    const std::vector<float> residual = values(shape.size(), 0.3F);
    const auto relu = EncoderNorm::Activation::kRelu;
    const float largest = EncoderNorm(shape, layout, gain, shift, InstructionSet::kPlain)
                              .run(expected.data(), residual.data(), relu);
    EXPECT_EQ(
        EncoderNorm(shape, layout, gain, shift, GetParam()).run(map.data(), residual.data(), relu),
        largest);
    EXPECT_EQ(map, expected);
    EXPECT_EQ(*std::max_element(map.begin(), map.end()), largest);
  }
}

TEST_P(EncoderKernelsOf, RoundToBytesWithinTheirRange) {
  // Times 2: -3 and 0 end at 0; 2.5 lies between 2 and 3, the even one; 3.5 gives 4; 254.4 and
  // 254.6 their neighbors; 300 the last byte.
  std::vector<float> from = {-1.5F, 0.0F, 1.25F, 1.75F, 127.2F, 127.3F, 150.0F, 0.5F};
  from.resize(32, 10.0F);
  std::vector<std::uint8_t> bytes(32);
  encoderKernels(GetParam()).toBytes(from.data(), 32, 2.0F, bytes.data());
  std::vector<std::uint8_t> expected = {0, 0, 2, 4, 254, 255, 255, 1};
  expected.resize(32, 20);
  EXPECT_EQ(bytes, expected);
}

TEST_P(EncoderKernelsOf, RoundToBfloat16OfEvenBits) {
  // A bfloat16 has 7 bits behind the point of 1.m: 1 + 2^-8 lies between 1 (even) and 1 + 2^-7, and
  // 1 + 3 x 2^-8 between 1 + 2^-7 (odd) and 1 + 2^-6. 0x3F80 are the bits of 1.
  std::vector<float> from = {1.0F + 0x1p-8F, 1.0F + 3 * 0x1p-8F, 1.0F + 0x1.1p-8F, -2.0F};
  from.resize(16, 1.0F);
  std::vector<std::uint16_t> halves(16);
  encoderKernels(GetParam()).toBfloat16(from.data(), 16, halves.data());
  std::vector<std::uint16_t> expected = {0x3F80, 0x3F82, 0x3F81, 0xC000};
  expected.resize(16, 0x3F80);
  EXPECT_EQ(halves, expected);
}

TEST(EncoderNorm, TakesItsMapInUnits) {
  // Normalization forgets a factor but for epsilon, which counts: x of 1e-3 has a variance of 5e-7.
  const MapShape shape{16, 4, 5};
  const Tensor gain{{16}, std::vector<float>(16, 1.0F)};
  const Tensor shift{{16}, std::vector<float>(16, 0.0F)};
  const EncoderNorm norm(shape, dnnl::memory::format_tag::nhwc, gain, shift);
  std::vector<float> plain = values(shape.size(), 1e-3F);
  std::vector<float> in_units = plain;
  for (float& value : in_units) value /= 0.25F;
  norm.run(plain.data(), nullptr, EncoderNorm::Activation::kNone);
  norm.run(in_units.data(), nullptr, EncoderNorm::Activation::kNone, 0.25);
  double squares = 0.0;
  for (std::size_t i = 0; i < plain.size(); ++i) {
    EXPECT_NEAR(in_units[i], plain[i], 1e-6);
    squares += static_cast<double>(plain[i] * plain[i]) / static_cast<double>(plain.size());
  }
  // variance / (variance + 1e-5) of about 5e-7: far below 1, so a forgotten unit would be seen.
  EXPECT_LT(squares, 0.1);
}

TEST(ConvolutionInput, ScalesTheLargestValueToTheLastByte) {
  // Of 51 as the largest a byte is worth 51 / 255 = 0.2.
  ConvolutionInput input(Precision::kInt8, 32);
  std::vector<float> map(32, 1.0F);
  map[3] = 51.0F;
  input.update(map.data(), 32, 51.0F);
  const auto* bytes = static_cast<const std::uint8_t*>(input.data(map.data()));
  EXPECT_NEAR(input.unit(), 0.2, 1e-7);
  EXPECT_EQ(bytes[3], 255);
  EXPECT_EQ(bytes[4], 5);
  input.update(std::vector<float>(32, 0.0F).data(), 32, 0.0F);
  EXPECT_EQ(input.unit(), 1.0);
  EXPECT_EQ(bytes[3], 0);
}

TEST(ConvolutionInput, IsTheMapItselfInFloat32) {
  ConvolutionInput input(Precision::kFp32, 16);
  std::vector<float> map(16, 2.0F);
  input.update(map.data(), 16, 2.0F);
  EXPECT_EQ(input.data(map.data()), map.data());
  EXPECT_EQ(input.unit(), 1.0);
}

TEST(Precision, IsWhatTheProcessorHas) {
  const std::string here = oneDnnInstructionSet("auto");
  const bool bytes =
      here == "avx512_core_vnni" || here == "avx512_core_bf16" || here == "avx512_core_amx";
  EXPECT_EQ(precisionNamed("auto", "auto", "p"), bytes ? Precision::kInt8 : Precision::kFp32);
  EXPECT_EQ(precisionNamed("auto", "avx2", "p"), Precision::kFp32);
  EXPECT_EQ(precisionNamed("fp32", "auto", "p"), Precision::kFp32);
}

TEST(Precision, ThatInstructionsRuleOutIsRefused) {
  try {
    precisionNamed("int8", "avx2", "diffusion.precision");
    FAIL() << "accepted";
  } catch (const core::InputError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("'diffusion.precision' is 'int8'"), std::string::npos) << text;
    EXPECT_NE(text.find("avx512_core_vnni"), std::string::npos) << text;
    EXPECT_NE(text.find("isa: avx2"), std::string::npos) << text;
  }
  EXPECT_THROW(precisionNamed("bf16", "avx2", "diffusion.precision"), core::InputError);
}

TEST(PrecisionDeathTest, InstructionsArePinnedBeforeOneDnnChooses) {
  ::testing::FLAGS_gtest_death_test_style =
      "threadsafe";  // a process in which nothing was computed
  const auto pinned = [] {
    pinOneDnn("avx2", "diffusion.isa");
    return oneDnnInstructionSet("auto") == "avx2";
  };
  if (bestInstructionSet() < InstructionSet::kAvx2) GTEST_SKIP() << "this CPU lacks avx2";
  EXPECT_EXIT(std::exit(pinned() ? 0 : 1), ::testing::ExitedWithCode(0), "");
}

TEST(Precision, InstructionsAreNotPinnedAfterOneDnnChose) {
  const std::string here = oneDnnInstructionSet("auto");
  if (here.rfind("avx512", 0) != 0) GTEST_SKIP() << "nothing above AVX2 here";
  EXPECT_THROW(pinOneDnn("avx2", "diffusion.isa"), core::InputError);
  EXPECT_NO_THROW(pinOneDnn("auto", "diffusion.isa"));
}

TEST(Precision, InstructionsThatTheEnvironmentRulesOutAreRefused) {
  ::setenv("E2E_CDIFF_ISA", "plain", 1);
  EXPECT_THROW(instructionSetNamed("avx2", "diffusion.isa"), core::InputError);
  EXPECT_EQ(instructionSetNamed("auto", "diffusion.isa"), InstructionSet::kPlain);
  ::unsetenv("E2E_CDIFF_ISA");
}

}  // namespace
}  // namespace cdiff::inference
