// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <cmath>

#include "benchmark.h"
#include "diffusion/network/image_encoder.h"
#include "e2e_cdiff/core/random.h"
#include "fma_peak.h"
#include "network_times.h"

namespace cdiff::benchmark {
namespace {

constexpr int kImages = 200;

/// Weights of variance 2 / fan-in; time does not depend on their values.
diffusion::Model randomModel() {
  const core::RandomStream random(1, "benchmark");
  diffusion::Model model;
  model.name = "random";
  std::uint32_t number = 0;
  for (const auto& [name, shape] : diffusion::encoderTensors(model.architecture)) {
    std::int64_t count = 1;
    for (const std::int64_t side : shape) count *= side;
    const double reach =
        shape.size() > 1 ? std::sqrt(6.0 * static_cast<double>(shape[0]) / count) : 1.0;
    inference::Tensor& tensor = model.encoder[name];
    tensor.shape = shape;
    for (std::int64_t i = 0; i < count; ++i) {
      tensor.values.push_back(static_cast<float>(
          random.uniform({0, number, 0}, static_cast<std::uint32_t>(i), -reach, reach)));
    }
    ++number;
  }
  return model;
}

std::int64_t halve(std::int64_t side, int times) {
  for (int i = 0; i < times; ++i) side = (side + 1) / 2;
  return side;
}

traffic::CameraImage randomImage(const diffusion::Architecture& sizes) {
  const core::RandomStream random(2, "benchmark");
  traffic::CameraImage image;
  image.width = static_cast<int>(sizes.image_width);
  image.height = static_cast<int>(sizes.image_height);
  for (int i = 0; i < image.width * image.height * 3; ++i)
    image.rgb.push_back(
        static_cast<std::uint8_t>(random.index({}, static_cast<std::uint32_t>(i), 256)));
  return image;
}

}  // namespace

double encoderOperations(const diffusion::Architecture& sizes) {
  double operations = 0.0;
  for (const auto& [name, shape] : diffusion::encoderTensors(sizes)) {
    if (shape.size() < 2) continue;
    const bool stem = name.rfind("stem", 0) == 0;
    const bool layer = name.rfind("layer", 0) == 0;
    const int halvings = stem ? 1 : layer ? name[5] - '0' + 1 : 5;
    double count = 2.0;
    for (const std::int64_t side : shape) count *= static_cast<double>(side);
    if (shape.size() == 4) {
      count *= static_cast<double>(halve(sizes.image_width, halvings) *
                                   halve(sizes.image_height, halvings));
    }
    operations += count;
  }
  return operations;
}

std::vector<double> encoderTimes(const diffusion::Model& model, inference::Precision precision) {
  const traffic::CameraImage image = randomImage(model.architecture);
  diffusion::ImageEncoder encoder(model, precision);
  for (int i = 0; i < 5; ++i) encoder.encode(image);
  std::vector<double> seconds;
  for (int i = 0; i < kImages; ++i) seconds.push_back(secondsOf([&] { encoder.encode(image); }));
  std::sort(seconds.begin(), seconds.end());
  return seconds;
}

void benchmarkEncoder(Figures& figures) {
  const diffusion::Model model = randomModel();
  const std::vector<double> seconds = encoderTimes(model, inference::Precision::kFp32);
  const double peak = measureFmaPeak();
  const double middle = median(seconds);
  const double rate = encoderOperations(model.architecture) / middle;
  figures.push_back({"encoder_image_p50", 1e3 * middle, "ms", "<=30"});
  figures.push_back({"encoder_image_p95", 1e3 * seconds[kImages * 95 / 100], "ms", ""});
  figures.push_back({"encoder_rate", 1e-9 * rate, "GFLOP/s", ""});
  figures.push_back({"fma_peak_of_one_core", 1e-9 * peak, "GFLOP/s", ""});
  figures.push_back({"encoder_share_of_peak", 100.0 * rate / peak, "%", ""});
}

}  // namespace cdiff::benchmark
