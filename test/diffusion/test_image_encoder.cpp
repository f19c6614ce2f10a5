// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <thread>

#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/core/random.h"
#include "e2e_cdiff/diffusion/image_encoder.h"
#include "encoder_norm.h"

namespace cdiff::diffusion {
namespace {

/// Weights uniform with variance 2 / fan-in (He), gains around 1, shifts and biases around 0.
Tensor randomTensor(const TensorShape& description, std::uint32_t number) {
  const core::RandomStream random(1, "image encoder test");
  std::int64_t count = 1;
  for (const std::int64_t side : description.shape) count *= side;
  const bool weight = description.shape.size() > 1;
  const double fan_in = static_cast<double>(count / description.shape[0]);
  const double reach = weight ? std::sqrt(6.0 / fan_in) : 0.5;
  const bool gain = !weight && description.name.find("weight") != std::string::npos;
  Tensor tensor;
  tensor.shape = description.shape;
  for (std::int64_t i = 0; i < count; ++i) {
    tensor.values.push_back(static_cast<float>(
        (gain ? 1.0 : 0.0) +
        random.uniform({0, number, 0}, static_cast<std::uint32_t>(i), -reach, reach)));
  }
  return tensor;
}

Model smallModel() {
  Model model;
  model.name = "random";
  model.architecture.image_width = 64;
  model.architecture.image_height = 32;
  std::uint32_t number = 0;
  for (const TensorShape& tensor : encoderTensors(model.architecture))
    model.encoder[tensor.name] = randomTensor(tensor, number++);
  return model;
}

/// The small model's tensors, made once, but for those whose shape depends on the size.
Model randomModel(std::int64_t width, std::int64_t height) {
  static const Model small = smallModel();
  Model model = small;
  model.architecture.image_width = width;
  model.architecture.image_height = height;
  for (const TensorShape& tensor : encoderTensors(model.architecture)) {
    if (model.encoder.at(tensor.name).shape != tensor.shape)
      model.encoder[tensor.name] = randomTensor(tensor, 1000);
  }
  return model;
}

traffic::CameraImage plainImage(int width, int height, std::uint8_t value) {
  traffic::CameraImage image;
  image.width = width;
  image.height = height;
  image.rgb.assign(static_cast<std::size_t>(width * height * 3), value);
  return image;
}

traffic::CameraImage randomImage(int width, int height) {
  const core::RandomStream random(2, "image encoder test");
  traffic::CameraImage image = plainImage(width, height, 0);
  for (std::size_t i = 0; i < image.rgb.size(); ++i)
    image.rgb[i] = static_cast<std::uint8_t>(random.index({}, static_cast<std::uint32_t>(i), 256));
  return image;
}

/// A map in plain [channel, row, column] order, double precision.
struct PlainMap {
  std::int64_t channels = 0;
  std::int64_t height = 0;
  std::int64_t width = 0;
  std::vector<double> values;

  PlainMap(std::int64_t c, std::int64_t h, std::int64_t w)
      : channels(c), height(h), width(w), values(static_cast<std::size_t>(c * h * w)) {}
  double& at(std::int64_t c, std::int64_t y, std::int64_t x) {
    return values[static_cast<std::size_t>((c * height + y) * width + x)];
  }
};

/// docs/network.md written down once more, without any care for speed.
class Reference {
 public:
  explicit Reference(const Model& model) : model_(model) {}

  std::vector<double> encode(const traffic::CameraImage& image) const {
    PlainMap map = pool(relu(norm(convolution(read(image), "stem.conv", 2), "stem.norm")));
    const int blocks[] = {3, 4, 6, 3};
    for (int layer = 1; layer <= 4; ++layer) {
      for (int block = 0; block < blocks[layer - 1]; ++block) {
        const std::string name = "layer" + std::to_string(layer) + "." + std::to_string(block);
        map = residualBlock(map, name, layer > 1 && block == 0 ? 2 : 1);
      }
    }
    return project(relu(convolution(map, "squeeze", 1)));
  }

 private:
  const Tensor& tensor(const std::string& name) const { return model_.encoder.at(name); }

  static PlainMap read(const traffic::CameraImage& image) {
    PlainMap map(3, image.height, image.width);
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x)
        for (int c = 0; c < 3; ++c) {
          const std::size_t index = static_cast<std::size_t>((y * image.width + x) * 3 + c);
          map.at(c, y, x) = (image.rgb[index] / 255.0 - 0.5) / 0.25;
        }
    return map;
  }

  PlainMap convolution(PlainMap in, const std::string& name, std::int64_t stride) const {
    const Tensor& weight = tensor(name + ".weight");
    const std::int64_t kernel = weight.shape[2];
    const std::int64_t padding = kernel / 2;
    PlainMap out(weight.shape[0], (in.height + 2 * padding - kernel) / stride + 1,
                 (in.width + 2 * padding - kernel) / stride + 1);
    const float* w = weight.values.data();
    for (std::int64_t o = 0; o < out.channels; ++o)
      for (std::int64_t i = 0; i < in.channels; ++i)
        for (std::int64_t dy = -padding; dy <= padding; ++dy)
          for (std::int64_t dx = -padding; dx <= padding; ++dx)
            addTap(in, out, o, i, {dy, dx, stride}, *w++);
    const auto bias = model_.encoder.find(name + ".bias");
    if (bias == model_.encoder.end()) return out;
    for (std::int64_t o = 0; o < out.channels; ++o)
      for (std::int64_t y = 0; y < out.height; ++y)
        for (std::int64_t x = 0; x < out.width; ++x)
          out.at(o, y, x) += bias->second.values[static_cast<std::size_t>(o)];
    return out;
  }

  struct Tap {
    std::int64_t dy;
    std::int64_t dx;
    std::int64_t stride;
  };
  static void addTap(PlainMap& in, PlainMap& out, std::int64_t o, std::int64_t i, const Tap& tap,
                     double weight) {
    for (std::int64_t y = 0; y < out.height; ++y) {
      const std::int64_t from_y = y * tap.stride + tap.dy;
      if (from_y < 0 || from_y >= in.height) continue;
      for (std::int64_t x = 0; x < out.width; ++x) {
        const std::int64_t from_x = x * tap.stride + tap.dx;
        if (from_x < 0 || from_x >= in.width) continue;
        out.at(o, y, x) += weight * in.at(i, from_y, from_x);
      }
    }
  }

  PlainMap norm(PlainMap map, const std::string& name) const {
    const Tensor& gain = tensor(name + ".weight");
    const Tensor& shift = tensor(name + ".bias");
    const std::size_t pixels = static_cast<std::size_t>(map.height * map.width);
    const std::size_t group = 16 * pixels;
    for (std::size_t begin = 0; begin < map.values.size(); begin += group) {
      double mean = 0.0;
      double variance = 0.0;
      for (std::size_t i = begin; i < begin + group; ++i) mean += map.values[i] / group;
      for (std::size_t i = begin; i < begin + group; ++i)
        variance += (map.values[i] - mean) * (map.values[i] - mean) / group;
      for (std::size_t i = begin; i < begin + group; ++i)
        map.values[i] =
            (map.values[i] - mean) / std::sqrt(variance + 1e-5) * gain.values[i / pixels] +
            shift.values[i / pixels];
    }
    return map;
  }

  static PlainMap relu(PlainMap map) {
    for (double& value : map.values) value = std::max(value, 0.0);
    return map;
  }

  static PlainMap pool(PlainMap in) {
    PlainMap out(in.channels, (in.height - 1) / 2 + 1, (in.width - 1) / 2 + 1);
    for (std::int64_t c = 0; c < out.channels; ++c)
      for (std::int64_t y = 0; y < out.height; ++y)
        for (std::int64_t x = 0; x < out.width; ++x) {
          double largest = 0.0;  // as small as anything after a ReLU
          for (std::int64_t v = std::max<std::int64_t>(2 * y - 1, 0);
               v <= std::min(2 * y + 1, in.height - 1); ++v)
            for (std::int64_t u = std::max<std::int64_t>(2 * x - 1, 0);
                 u <= std::min(2 * x + 1, in.width - 1); ++u)
              largest = std::max(largest, in.at(c, v, u));
          out.at(c, y, x) = largest;
        }
    return out;
  }

  PlainMap residualBlock(const PlainMap& in, const std::string& name, std::int64_t stride) const {
    PlainMap map = relu(norm(convolution(in, name + ".conv1", stride), name + ".norm1"));
    map = norm(convolution(map, name + ".conv2", 1), name + ".norm2");
    const bool down = model_.encoder.count(name + ".down.conv.weight") > 0;
    const PlainMap shortcut =
        down ? norm(convolution(in, name + ".down.conv", stride), name + ".down.norm") : in;
    for (std::size_t i = 0; i < map.values.size(); ++i) map.values[i] += shortcut.values[i];
    return relu(map);
  }

  std::vector<double> project(const PlainMap& map) const {
    const Tensor& weight = tensor("project.weight");
    const Tensor& bias = tensor("project.bias");
    std::vector<double> features;
    for (std::size_t o = 0; o < bias.values.size(); ++o) {
      double sum = bias.values[o];
      for (std::size_t i = 0; i < map.values.size(); ++i)
        sum += weight.values[o * map.values.size() + i] * map.values[i];
      features.push_back(sum);
    }
    return features;
  }

  const Model& model_;
};

/// Largest difference of any feature over the root mean square of all.
double relativeError(const std::vector<float>& features, const std::vector<double>& expected) {
  EXPECT_EQ(features.size(), expected.size());
  double largest = 0.0;
  double squares = 0.0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    largest = std::max(largest, std::abs(features[i] - expected[i]));
    squares += expected[i] * expected[i];
  }
  return largest / std::sqrt(squares / static_cast<double>(expected.size()));
}

TEST(ImageEncoder, AgreesWithThePlainReference) {
  // 64 x 32 halves five times to 2 x 1; 72 x 40 (not multiples of 32) ends at 3 x 2; 160 x 96 is
  // what ships.
  const std::pair<int, int> sizes[] = {{64, 32}, {72, 40}, {160, 96}};
  for (const auto& [width, height] : sizes) {
    const Model model = randomModel(width, height);
    const traffic::CameraImage image = randomImage(width, height);
    const double error =
        relativeError(ImageEncoder(model).encode(image), Reference(model).encode(image));
    EXPECT_LT(error, 1e-4) << width << " x " << height;
    RecordProperty("relative_error_" + std::to_string(width), std::to_string(error));
  }
}

TEST(ImageEncoder, RepeatsItsBytes) {
  const Model model = randomModel(160, 96);
  const traffic::CameraImage image = randomImage(160, 96);
  ImageEncoder first(model);
  const std::vector<float> features = first.encode(image);
  first.encode(plainImage(160, 96, 255));
  EXPECT_EQ(first.encode(image), features);
  ImageEncoder second(model);
  EXPECT_EQ(second.encode(image), features);
  ImageEncoder moved(std::move(first));
  EXPECT_EQ(moved.encode(image), features);
}

TEST(ImageEncoder, EncodersOfTwoThreadsDoNotDisturbEachOther) {
  const Model model = randomModel(64, 32);
  const std::vector<traffic::CameraImage> images = {randomImage(64, 32), plainImage(64, 32, 200)};
  std::vector<std::vector<float>> expected;
  for (const traffic::CameraImage& image : images)
    expected.push_back(ImageEncoder(model).encode(image));
  std::array<int, 2> wrong{};
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < 2; ++i) {
    threads.emplace_back([&, i] {
      ImageEncoder encoder(model);
      for (int round = 0; round < 20; ++round) wrong[i] += encoder.encode(images[i]) != expected[i];
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(wrong[0], 0);
  EXPECT_EQ(wrong[1], 0);
}

TEST(ImageEncoder, TellsBlackFromWhite) {
  ImageEncoder encoder(randomModel(64, 32));
  EXPECT_NE(encoder.encode(plainImage(64, 32, 0)), encoder.encode(plainImage(64, 32, 255)));
}

TEST(ImageEncoder, RefusesAnotherSizeNamingBoth) {
  ImageEncoder encoder(randomModel(64, 32));
  try {
    encoder.encode(plainImage(32, 64, 0));  // as many bytes, but turned
    FAIL() << "accepted";
  } catch (const std::invalid_argument& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("32 x 64"), std::string::npos) << text;
    EXPECT_NE(text.find("64 x 32"), std::string::npos) << text;
  }
  traffic::CameraImage short_image = plainImage(64, 32, 0);
  short_image.rgb.pop_back();
  EXPECT_THROW(encoder.encode(short_image), std::invalid_argument);
}

TEST(ImageEncoder, NamesATensorThatIsMissingOrMisshapen) {
  Model model = randomModel(64, 32);
  model.encoder["layer3.2.norm1.bias"].shape = {128};
  try {
    ImageEncoder encoder(model);
    FAIL() << "accepted";
  } catch (const core::InputError& error) {
    EXPECT_NE(std::string(error.what()).find("'layer3.2.norm1.bias'"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("[128], but must be [256]"), std::string::npos);
  }
  model = randomModel(64, 32);
  model.encoder.erase("squeeze.bias");
  EXPECT_THROW(ImageEncoder{model}, core::InputError);
}

TEST(ImageEncoder, NamesItsInstructionSet) { EXPECT_FALSE(ImageEncoder::instructionSet().empty()); }

/// Normalises channel c, pixel p of the value 1000 c + p^2 (32 channels of 2 x 3 pixels) in a
/// layout, and returns [channel, pixel].
std::vector<double> normalised(dnnl::memory::format_tag layout, bool residual,
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
            normalised(layout, residual,
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
}  // namespace cdiff::diffusion
