// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <cpuid.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>

#include "diffusion/network/image_encoder.h"
#include "diffusion/reference_encoder.h"
#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/core/random.h"

namespace cdiff::diffusion {
namespace {

/// Weights uniform with variance 2 / fan-in (He), gains around 1, shifts and biases around 0.
inference::Tensor randomTensor(const inference::TensorShape& description, std::uint32_t number) {
  const core::RandomStream random(1, "image encoder test");
  std::int64_t count = 1;
  for (const std::int64_t side : description.shape) count *= side;
  const bool weight = description.shape.size() > 1;
  const std::int64_t fan_in = count / description.shape[0];
  const double reach = weight ? std::sqrt(6.0 / static_cast<double>(fan_in)) : 0.5;
  const bool gain = !weight && description.name.find("weight") != std::string::npos;
  inference::Tensor tensor;
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
  for (const inference::TensorShape& tensor : encoderTensors(model.architecture))
    model.encoder[tensor.name] = randomTensor(tensor, number++);
  return model;
}

/// The small model's tensors, made once, but for those whose shape depends on the size.
Model randomModel(std::int64_t width, std::int64_t height) {
  static const Model small = smallModel();
  Model model = small;
  model.architecture.image_width = width;
  model.architecture.image_height = height;
  for (const inference::TensorShape& tensor : encoderTensors(model.architecture)) {
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
        relativeError(ImageEncoder(model).encode(image), ReferenceEncoder(model).encode(image));
    EXPECT_LT(error, 1e-4) << width << " x " << height;
    RecordProperty("relative_error_" + std::to_string(width), std::to_string(error));
  }
}

/// Precisions below float32 that this processor has.
std::vector<inference::Precision> narrowPrecisions() {
  std::vector<inference::Precision> here;
  for (const char* name : {"bf16", "int8"}) {
    try {
      here.push_back(inference::precisionNamed(name, "auto", "precision"));
    } catch (const core::InputError&) {
    }
  }
  return here;
}

TEST(ImageEncoder, AgreesInNarrowPrecisionsWithThePlainReference) {
  const Model model = randomModel(160, 96);
  const traffic::CameraImage image = randomImage(160, 96);
  const std::vector<double> expected = ReferenceEncoder(model).encode(image);
  const std::vector<inference::Precision> precisions = narrowPrecisions();
  if (precisions.empty()) GTEST_SKIP() << "this processor has float32 alone";
  for (const inference::Precision precision : precisions) {
    ImageEncoder encoder(model, precision);
    const std::vector<float> features = encoder.encode(image);
    const double error = relativeError(features, expected);
    RecordProperty("relative_error_" + inference::toText(precision), std::to_string(error));
    EXPECT_LT(error, 0.1) << inference::toText(precision);
    EXPECT_GT(error, 1e-4) << inference::toText(precision) << ": is that float32?";
    EXPECT_EQ(encoder.encode(image), features);
    EXPECT_EQ(ImageEncoder(model, precision, inference::InstructionSet::kPlain).encode(image),
              features)
        << "kernels between the convolutions give other bytes";
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

/// KiB of the second-level cache, as this process sees it; 0 where the processor does not say.
unsigned secondLevelCache() {
  for (unsigned i = 0; i < 8; ++i) {
    unsigned eax = 0, ebx = 0, ecx = 0, edx = 0;
    if (__get_cpuid_count(4, i, &eax, &ebx, &ecx, &edx) == 0 || (eax & 31U) == 0) break;
    if (((eax >> 5U) & 7U) == 2)
      return ((ebx >> 22U) + 1) * (((ebx >> 12U) & 1023U) + 1) * ((ebx & 4095U) + 1) * (ecx + 1) /
             1024;
  }
  return 0;
}

/// Run by the test below, in processes that see other caches.
TEST(ImageEncoder, DISABLED_PrintItsBytes) {
  const Model model = randomModel(160, 96);
  std::cout << "cache " << secondLevelCache() << "\nbytes";
  for (const char* name : {"fp32", "auto"}) {
    const auto precision = inference::precisionNamed(name, "auto", name);
    const std::vector<float> features = ImageEncoder(model, precision).encode(randomImage(160, 96));
    const std::string_view bytes(reinterpret_cast<const char*>(features.data()),
                                 features.size() * sizeof(float));
    std::cout << " " << core::hashText(bytes);
  }
  std::cout << std::endl;
}

/// The lines "cache" and "bytes" of the test above, where the second-level cache has so many KiB.
std::array<std::string, 2> bytesWithCache(unsigned kibibytes) {
  const std::string command = "FAKE_L1_KIB=32 FAKE_L2_KIB=" + std::to_string(kibibytes) +
                              " LD_PRELOAD=" + FAKE_CACHES + " " +
                              std::filesystem::read_symlink("/proc/self/exe").string() +
                              " --gtest_also_run_disabled_tests "
                              "--gtest_filter=ImageEncoder.DISABLED_PrintItsBytes";
  const std::unique_ptr<FILE, int (*)(FILE*)> output(::popen(command.c_str(), "r"), ::pclose);
  std::array<std::string, 2> lines;
  std::array<char, 256> buffer{};
  while (std::fgets(buffer.data(), buffer.size(), output.get()) != nullptr) {
    const std::string line = buffer.data();
    if (line.rfind("cache", 0) == 0) lines[0] = line;
    if (line.rfind("bytes", 0) == 0) lines[1] = line;
  }
  return lines;
}

// Two processors of one instruction set have other caches.
TEST(ImageEncoder, ComesToTheSameBytesWhateverTheCaches) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers take the signal that this needs";
#endif
  const auto small = bytesWithCache(256);
  if (small[0] != "cache 256\n")
    GTEST_SKIP() << "no CPUID faulting here: " << small[0] << "cannot be changed";
  const auto large = bytesWithCache(2048);
  EXPECT_EQ(large[0], "cache 2048\n");
  EXPECT_GT(small[1].size(), 10U) << small[1];
  EXPECT_EQ(small[1], large[1]);
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

TEST(ImageEncoder, DistinguishesBlackFromWhite) {
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

}  // namespace
}  // namespace cdiff::diffusion
