// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "e2e_cdiff/core/random.h"
#include "inference/safetensors.h"
#include "inference/weight_file_text.h"

namespace cdiff::inference {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Reads back whatever tensors `content` has.
SafetensorsFile readBack(const std::filesystem::path& file, const SafetensorsFile& content) {
  return readSafetensors(file, [&](const std::map<std::string, std::string>&) {
    std::vector<inference::TensorShape> shapes;
    for (const auto& [name, tensor] : content.tensors) shapes.push_back({name, tensor.shape});
    return shapes;
  });
}

class Safetensors : public ::testing::Test {
 protected:
  /// The values after a round trip through a file of one tensor.
  std::vector<float> roundTrip(const std::vector<float>& values, TensorType type) {
    const SafetensorsFile content{{},
                                  {{"t", {{static_cast<std::int64_t>(values.size())}, values}}}};
    writeSafetensors(file_, content, type);
    return readBack(file_, content).tensors.at("t").values;
  }
  std::string writeError(const std::vector<float>& values, TensorType type) {
    return test::inputErrorOf([&] { roundTrip(values, type); });
  }

  test::TemporaryFolder folder_;
  std::filesystem::path file_ = folder_.path() / "file.safetensors";
};

TEST_F(Safetensors, F32RoundTripIsExact) {
  SafetensorsFile content;
  content.metadata = {{"note", "a \"quoted\" text\nof two lines"}};
  content.tensors["b.weight"] = {{2, 3}, {1.0F, -0.0F, 1e-45F, 3.4028235e38F, 0.1F, -7.25F}};
  content.tensors["a"] = {{1}, {1.1754944e-38F}};
  content.tensors["scalar"] = {{}, {42.0F}};
  writeSafetensors(file_, content, TensorType::kF32);
  const SafetensorsFile back = readBack(file_, content);
  EXPECT_EQ(back.metadata.at("note"), content.metadata.at("note"));
  EXPECT_EQ(back.metadata.at("sha256").size(), 64u);
  ASSERT_EQ(back.tensors.size(), 3u);
  for (const auto& [name, tensor] : content.tensors) {
    EXPECT_EQ(back.tensors.at(name).shape, tensor.shape) << name;
    EXPECT_EQ(test::floatBytes(back.tensors.at(name).values), test::floatBytes(tensor.values))
        << name;
  }
}

TEST_F(Safetensors, BytesOfASmallFile) {
  // 1.0F is 0x3F800000 and 2.0 in half precision 0x4000; the header is padded to 8 bytes.
  const SafetensorsFile content{{{"k", "v"}}, {{"t", {{1}, {1.0F}}}}};
  writeSafetensors(file_, content, TensorType::kF32);
  const std::string data("\x00\x00\x80\x3F", 4);
  std::string header = "{\"__metadata__\":{\"k\":\"v\",\"sha256\":\"" + core::sha256(data) +
                       "\"},\"t\":{\"dtype\":\"F32\",\"shape\":[1],\"data_offsets\":[0,4]}}";
  while (header.size() % 8 != 0) header += ' ';
  EXPECT_EQ(test::readBytes(file_), test::weightFile(header, data));
  writeSafetensors(file_, {{}, {{"t", {{1}, {2.0F}}}}}, TensorType::kF16);
  const std::string bytes = test::readBytes(file_);
  EXPECT_EQ(bytes.substr(bytes.size() - 2), std::string("\x00\x40", 2));
}

TEST_F(Safetensors, F16RoundsToNearestEven) {
  // Half precision has 11 significant bits: neighbors of 1 are 1 + n 2^-10, smallest subnormals
  // n 2^-24, largest 65504 (spacing 32).
  const auto two = [](int exponent) { return std::ldexp(1.0F, exponent); };
  const std::vector<float> given = {1.0F + two(-11),         // tie of n = 0 and 1
                                    1.0F + 3.0F * two(-11),  // tie of n = 1 and 2
                                    1.0F + two(-11) + two(-20),
                                    two(-24),
                                    1023.0F * two(-24),   // largest subnormal
                                    two(-25),             // tie of 0 and 2^-24
                                    two(-25) + two(-40),  // just above it
                                    1.5F * two(-24),      // tie of n = 1 and 2
                                    2.5F * two(-24),      // tie of n = 2 and 3
                                    1023.5F * two(-24),   // tie of subnormal and 2^-14
                                    65504.0F,
                                    65519.996F,
                                    -0.0F,
                                    -2.5F * two(-24)};
  const std::vector<float> expected = {
      1.0F,     1.0F + two(-9), 1.0F + two(-10), two(-24), 1023.0F * two(-24), 0.0F,  two(-24),
      two(-23), two(-23),       two(-14),        65504.0F, 65504.0F,           -0.0F, -two(-23)};
  EXPECT_EQ(test::floatBytes(roundTrip(given, TensorType::kF16)), test::floatBytes(expected));
}

TEST_F(Safetensors, F16KeepsElevenBits) {
  // Rounding errs by at most half a unit in the last place: 2^-11 of a normal value, 2^-25 below.
  const core::RandomStream random(1, "halves");
  std::vector<float> values;
  for (std::uint32_t i = 0; i < 20000; ++i) {
    const double exponent = random.uniform({}, 2 * i, -26.0, 15.9);
    const double sign = random.uniform({}, 2 * i + 1) < 0.5 ? -1.0 : 1.0;
    values.push_back(static_cast<float>(sign * std::exp2(exponent)));
  }
  const std::vector<float> back = roundTrip(values, TensorType::kF16);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double value = values[i];
    const double bound = std::max(std::ldexp(std::abs(value), -11), std::ldexp(1.0, -25));
    ASSERT_LE(std::abs(static_cast<double>(back[i]) - value), bound) << value;
  }
  EXPECT_EQ(roundTrip(back, TensorType::kF16), back);
}

TEST_F(Safetensors, ValuesThatTheTypeCannotHoldAreRefused) {
  // From 65520 on, halfway to 65536, a half is infinite.
  EXPECT_NE(writeError({1.0F, 65520.0F}, TensorType::kF16).find("'t' holds 65520 at element 1"),
            std::string::npos);
  EXPECT_EQ(writeError({65520.0F}, TensorType::kF32), "no error");
  EXPECT_NE(writeError({-kInfinity}, TensorType::kF32).find("'t' holds -inf"), std::string::npos);
  EXPECT_NE(writeError({std::nanf("")}, TensorType::kF16).find("'t' holds nan"), std::string::npos);
}

TEST_F(Safetensors, TensorsWhoseValuesDoNotFillTheShapeAreRefused) {
  EXPECT_THROW(writeSafetensors(file_, {{}, {{"t", {{2, 2}, {1.0F}}}}}, TensorType::kF32),
               std::invalid_argument);
  EXPECT_THROW(writeSafetensors(file_, {{}, {{"t", {{-1}, {}}}}}, TensorType::kF32),
               std::invalid_argument);
  EXPECT_THROW(writeSafetensors(file_, {{}, {{"__metadata__", {{1}, {1.0F}}}}}, TensorType::kF32),
               std::invalid_argument);
  EXPECT_FALSE(std::filesystem::exists(file_));
}

TEST_F(Safetensors, TensorsMayLieInAnyOrder) {
  const std::string data = test::floatBytes({1.0F, 2.0F, 3.0F});
  const std::string header = "{\"__metadata__\":{\"sha256\":\"" + core::sha256(data) +
                             "\"},\"a\":{\"dtype\":\"F32\",\"shape\":[1],\"data_offsets\":[8,12]},"
                             "\"b\":{\"shape\":[2],\"data_offsets\":[0,8],\"dtype\":\"F32\"}}";
  test::writeBytes(file_, test::weightFile(header, data));
  const SafetensorsFile back = readBack(file_, {{}, {{"a", {{1}, {}}}, {"b", {{2}, {}}}}});
  EXPECT_EQ(back.tensors.at("a").values, (std::vector<float>{3.0F}));
  EXPECT_EQ(back.tensors.at("b").values, (std::vector<float>{1.0F, 2.0F}));
}

}  // namespace
}  // namespace cdiff::inference
