// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <functional>
#include <map>

#include "diffusion/network/architecture.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::diffusion {
namespace {

using Shape = std::vector<std::int64_t>;

std::map<std::string, Shape> byName(const std::vector<inference::TensorShape>& tensors) {
  std::map<std::string, Shape> map;
  for (const inference::TensorShape& tensor : tensors) map[tensor.name] = tensor.shape;
  EXPECT_EQ(map.size(), tensors.size()) << "a name occurs twice";
  return map;
}

std::int64_t elementCount(const std::vector<inference::TensorShape>& tensors) {
  std::int64_t sum = 0;
  for (const inference::TensorShape& tensor : tensors) {
    std::int64_t count = 1;
    for (const std::int64_t size : tensor.shape) count *= size;
    sum += count;
  }
  return sum;
}

std::string errorOf(const std::function<void()>& action) {
  try {
    action();
  } catch (const core::InputError& error) {
    return error.what();
  }
  return "no error";
}

void expectMentions(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << "'" << part << "' is not in: " << text;
}

TEST(Architecture, DenoiserTensorsAreThoseOfTheDocument) {
  const std::map<std::string, Shape> tensors = byName(denoiserTensors(Architecture()));
  const std::map<std::string, Shape> expected = {{"down.0.a.block1.conv.weight", {32, 7, 5}},
                                                 {"down.0.a.block1.conv.bias", {32}},
                                                 {"down.0.a.block1.norm.weight", {32}},
                                                 {"down.0.a.inject.weight", {32, 192}},
                                                 {"down.0.a.inject.bias", {32}},
                                                 {"down.0.a.block2.conv.weight", {32, 32, 5}},
                                                 {"down.0.a.skip.weight", {32, 7, 1}},
                                                 {"down.0.sample.weight", {32, 32, 3}},
                                                 {"down.1.sample.bias", {64}},
                                                 {"down.2.b.block2.norm.bias", {128}},
                                                 {"middle.b.block1.conv.weight", {128, 128, 5}},
                                                 {"up.0.a.block1.conv.weight", {64, 256, 5}},
                                                 {"up.0.a.skip.weight", {64, 256, 1}},
                                                 {"up.0.sample.weight", {64, 64, 4}},
                                                 {"up.1.a.block1.conv.weight", {32, 128, 5}},
                                                 {"up.1.sample.weight", {32, 32, 4}},
                                                 {"head.block.conv.weight", {32, 32, 5}},
                                                 {"head.block.norm.bias", {32}},
                                                 {"head.out.weight", {3, 32, 1}},
                                                 {"route.0.weight", {128, 32}},
                                                 {"route.2.weight", {64, 128}},
                                                 {"no_route", {64}},
                                                 {"speed.0.weight", {32, 1}},
                                                 {"context.0.weight", {128, 352}},
                                                 {"time.0.weight", {256, 64}},
                                                 {"time.2.weight", {64, 256}},
                                                 {"state.0.weight", {256, 161}},
                                                 {"state.2.weight", {256, 256}},
                                                 {"state.4.weight", {128, 256}},
                                                 {"state.4.bias", {128}}};
  for (const auto& [name, shape] : expected) {
    ASSERT_EQ(tensors.count(name), 1u) << name;
    EXPECT_EQ(tensors.at(name), shape) << name;
  }
  for (const char* absent : {"down.0.b.skip.weight", "down.2.sample.weight", "up.2.a.skip.weight",
                             "middle.a.skip.weight"}) {
    EXPECT_EQ(tensors.count(absent), 0u) << absent;
  }
  // Conditioning 13; a block has 10 tensors, 12 with a skip: down 24 + 24 + 22, middle 20, up 24 +
  // 24 (with sample); head 6; state head 6.
  EXPECT_EQ(tensors.size(), 163u);
}

TEST(Architecture, EncoderTensorsAreThoseOfResnet34) {
  const std::vector<inference::TensorShape> list = encoderTensors(Architecture());
  const std::map<std::string, Shape> tensors = byName(list);
  const std::map<std::string, Shape> expected = {{"stem.conv.weight", {64, 3, 7, 7}},
                                                 {"stem.norm.weight", {64}},
                                                 {"layer1.0.conv1.weight", {64, 64, 3, 3}},
                                                 {"layer1.0.norm1.weight", {64}},
                                                 {"layer2.0.conv1.weight", {128, 64, 3, 3}},
                                                 {"layer2.0.down.conv.weight", {128, 64, 1, 1}},
                                                 {"layer2.0.down.norm.weight", {128}},
                                                 {"layer3.5.conv2.weight", {256, 256, 3, 3}},
                                                 {"layer4.2.norm2.bias", {512}},
                                                 {"squeeze.weight", {64, 512, 1, 1}},
                                                 {"squeeze.bias", {64}},
                                                 {"project.weight", {256, 960}},
                                                 {"project.bias", {256}}};
  for (const auto& [name, shape] : expected) {
    ASSERT_EQ(tensors.count(name), 1u) << name;
    EXPECT_EQ(tensors.at(name), shape) << name;
  }
  EXPECT_EQ(tensors.count("layer1.0.down.conv.weight"), 0u);
  // Stem 3, 16 blocks of 6, 3 down-samplings of 3, squeeze 2, project 2.
  EXPECT_EQ(tensors.size(), 112u);
  // ResNet-34 has 21,797,672 parameters, 513,000 of them in its classifier; ours adds the squeeze
  // (512 x 64 + 64) and the projection (960 x 256 + 256).
  EXPECT_EQ(elementCount(list), 21797672 - 513000 + 32832 + 246016);
}

TEST(Architecture, SizesEndWhereTheyShould) {
  struct Range {
    const char* name;
    std::int64_t Architecture::*size;
    std::int64_t low;
    std::int64_t high;
  };
  const Range ranges[] = {{"horizon", &Architecture::horizon, 2, 1024},
                          {"diffusion_steps", &Architecture::diffusion_steps, 1, 10000},
                          {"kernel", &Architecture::kernel, 1, 31},
                          {"time_width", &Architecture::time_width, 4, 4096},
                          {"image_width", &Architecture::image_width, 32, 4096},
                          {"image_height", &Architecture::image_height, 32, 4096},
                          {"image_features", &Architecture::image_features, 1, 4096},
                          {"route_points", &Architecture::route_points, 1, 1024},
                          {"state_hidden", &Architecture::state_hidden, 1, 4096}};
  for (const Range& range : ranges) {
    for (const std::int64_t beyond : {range.low - 1, range.high + 1}) {
      Architecture a;
      a.*range.size = beyond;
      try {
        a.validate();
        ADD_FAILURE() << range.name << " " << beyond;
      } catch (const core::InputError& error) {
        const std::string expected = std::string(range.name) + " is " + std::to_string(beyond) +
                                     "; " + std::to_string(range.low) + " to " +
                                     std::to_string(range.high) + " was expected";
        EXPECT_NE(std::string(error.what()).find(expected), std::string::npos) << error.what();
      }
    }
  }
}

TEST(Architecture, OtherSizes) {
  Architecture a;
  a.horizon = 16;
  a.channels = {16, 24};
  a.kernel = 3;
  a.image_width = 100;  // 50, 25, 13, 7, 4 pixels
  a.image_height = 33;  // 17, 9, 5, 3, 2 pixels
  a.validate();
  const std::map<std::string, Shape> denoiser = byName(denoiserTensors(a));
  EXPECT_EQ(denoiser.at("up.0.a.block1.conv.weight"), (Shape{16, 48, 3}));
  EXPECT_EQ(denoiser.at("up.0.sample.weight"), (Shape{16, 16, 4}));
  EXPECT_EQ(denoiser.count("up.1.sample.weight"), 0u);
  EXPECT_EQ(denoiser.at("state.0.weight"), (Shape{256, 16 * 3 + 1 + 64}));
  EXPECT_EQ(denoiser.at("state.4.weight"), (Shape{64, 256}));
  EXPECT_EQ(byName(encoderTensors(a)).at("project.weight"), (Shape{256, 64 * 4 * 2}));
}

TEST(Architecture, JsonRoundTrip) {
  Architecture a;
  a.horizon = 16;
  a.channels = {16, 24};
  a.route_spacing = 0.1 + 0.2;
  a.state_hidden = 17;
  EXPECT_FALSE(a == Architecture());
  EXPECT_TRUE(Architecture::fromJson(a.toJson(), "test") == a);
}

// Weights that were made before the image before and the target speed were inputs do not name them.
TEST(Architecture, InputsOfMotionAreNamedOnlyWhereTheyAreTaken) {
  EXPECT_EQ(Architecture().toJson().find("previous_frame"), std::string::npos);
  EXPECT_EQ(Architecture().toJson().find("target_features"), std::string::npos);
  const Architecture motion = Architecture().withMotion();
  EXPECT_NE(motion.toJson().find("\"previous_frame\":4"), std::string::npos);
  EXPECT_TRUE(Architecture::fromJson(motion.toJson(), "test") == motion);
  EXPECT_FALSE(motion == Architecture());
  EXPECT_TRUE(motion.imageAlone() == Architecture().imageAlone());
  EXPECT_EQ(motion.joinedFeatures(), Architecture().joinedFeatures() + 256 + 32);
}

TEST(Architecture, RowsOfTheCurrentStateAreNamedOnlyWhereItIsPinned) {
  EXPECT_EQ(Architecture().imageAlone().toJson().find("current_state_rows"), std::string::npos);
  const Architecture pinned = Architecture().pinned();
  EXPECT_EQ(pinned.rows(), pinned.horizon + 4);
  EXPECT_TRUE(Architecture::fromJson(pinned.toJson(), "test") == pinned);
  EXPECT_FALSE(pinned == Architecture().imageAlone());
  EXPECT_TRUE(pinned.imageAlone() == Architecture().imageAlone());
  // The speed is an input of the state head, and none of the context.
  EXPECT_EQ(byName(denoiserTensors(pinned)).at("state.0.weight"), (Shape{256, 96 + 1 + 64}));
  EXPECT_EQ(pinned.contextValues(), pinned.image_features);
  Architecture uneven = pinned;
  uneven.current_state_rows = 3;
  expectMentions(errorOf([&] { uneven.validate(); }), "current_state_rows is 3; a multiple of");
}

/// The default architecture as JSON with a piece of its text replaced.
std::string jsonError(const std::string& from, const std::string& to) {
  std::string text = Architecture().toJson();
  const std::size_t place = text.find(from);
  EXPECT_NE(place, std::string::npos) << from;
  text.replace(place, from.size(), to);
  return errorOf([&] { Architecture::fromJson(text, "file 'f'"); });
}

TEST(Architecture, JsonFaultsAreNamed) {
  expectMentions(jsonError("\"kernel\":5,", ""),
                 "file 'f': the architecture lacks the key 'kernel'");
  expectMentions(jsonError("\"kernel\"", "\"kernal\""), "unknown key 'kernal'");
  expectMentions(jsonError("\"kernel\"", "\"kernal\""), "nearest known one is 'kernel'");
  expectMentions(jsonError("\"kernel\":5", "\"kernel\":\"5\""), "kernel is a string");
  expectMentions(jsonError("\"kernel\":5", "\"kernel\":5.0"), "kernel is a number with a fraction");
  expectMentions(jsonError("\"kernel\":5", "\"kernel\":4"), "kernel is 4; an odd one");
  expectMentions(jsonError("\"kernel\":5", "\"kernel\":5,\"kernel\":7"), "duplicate key 'kernel'");
  expectMentions(jsonError("\"groups\":8", "\"groups\":18446744073709551615"),
                 "groups is 18446744073709551615");
  expectMentions(jsonError("[32,64,128]", "32"), "channels is an integer");
  expectMentions(jsonError("[32,64,128]", "[32,true]"), "channels (an element) is a boolean");
  expectMentions(jsonError("3.0", "\"3\""), "route_spacing is a string");
  expectMentions(jsonError("{", ""), "file 'f': the architecture is not JSON");
  expectMentions(errorOf([] { Architecture::fromJson("[]", "file 'f'"); }), "is an array");
}

std::string sizeError(const std::function<void(Architecture&)>& change) {
  Architecture architecture;
  change(architecture);
  return errorOf([&] { architecture.validate(); });
}

TEST(Architecture, SizesThatDoNotFitAreNamed) {
  EXPECT_EQ(sizeError([](Architecture&) {}), "no error");
  expectMentions(sizeError([](Architecture& a) { a.horizon = 30; }), "horizon is 30; a multiple");
  expectMentions(sizeError([](Architecture& a) { a.horizon = 0; }), "horizon is 0");
  expectMentions(sizeError([](Architecture& a) { a.diffusion_steps = 0; }), "diffusion_steps is 0");
  expectMentions(sizeError([](Architecture& a) {
                   a.channels = {32, 60, 128};
                 }),
                 "is 60; a multiple");
  expectMentions(sizeError([](Architecture& a) { a.channels = {32}; }), "count of channels is 1");
  expectMentions(sizeError([](Architecture& a) { a.channels = {32, -8}; }), "is -8");
  expectMentions(sizeError([](Architecture& a) { a.time_width = 65; }), "time_width is 65");
  expectMentions(sizeError([](Architecture& a) { a.image_width = std::int64_t{1} << 40; }),
                 "image_width is 1099511627776");
  expectMentions(sizeError([](Architecture& a) { a.route_spacing = 0.0; }), "route_spacing is 0");
}

}  // namespace
}  // namespace cdiff::diffusion
