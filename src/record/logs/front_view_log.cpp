// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "record/logs/front_view_log.h"

#include <openssl/evp.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::record {
namespace {

constexpr int kJpegQuality = 72;

std::vector<std::uint8_t> encoded(const traffic::CameraImage& image, const char* format,
                                  const std::vector<int>& settings) {
  if (!isWhole(image)) {
    throw core::InputError("an image of " + std::to_string(image.width) + " x " +
                           std::to_string(image.height) + " pixels has " +
                           std::to_string(image.rgb.size()) + " bytes");
  }
  cv::Mat blue_first(image.height, image.width, CV_8UC3);
  for (std::size_t i = 0; i < image.rgb.size(); i += 3) {
    blue_first.data[i] = image.rgb[i + 2];
    blue_first.data[i + 1] = image.rgb[i + 1];
    blue_first.data[i + 2] = image.rgb[i];
  }
  std::vector<std::uint8_t> bytes;
  cv::imencode(format, blue_first, bytes, settings);
  return bytes;
}

}  // namespace

bool isWhole(const traffic::CameraImage& image) {
  if (image.width <= 0 || image.height <= 0) return false;
  return image.rgb.size() ==
         3 * static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
}

std::string base64(const std::vector<std::uint8_t>& bytes) {
  std::string text((bytes.size() + 2) / 3 * 4, '\0');  // the terminating zero fits, too
  EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()), bytes.data(),
                  static_cast<int>(bytes.size()));
  return text;
}

std::string pngDataUri(const traffic::CameraImage& image) {
  return "data:image/png;base64," +
         base64(encoded(image, ".png", {cv::IMWRITE_PNG_COMPRESSION, 9}));
}

std::vector<std::uint8_t> jpegOf(const traffic::CameraImage& image) {
  return encoded(image, ".jpg", {cv::IMWRITE_JPEG_QUALITY, kJpegQuality});
}

namespace {

constexpr std::int64_t kWidth = 320;   // [pixels]
constexpr std::int64_t kHeight = 192;  // [pixels]

std::uint64_t ticksPerView(const session::ScenarioOptions& options) {
  const double rate = options.report.front_view_rate;
  if (rate <= 0.0) return 0;
  const double ticks = std::round(1.0 / (rate * options.simulation_step));
  return static_cast<std::uint64_t>(std::max(1.0, ticks));
}

bool canBeDrawn(const traffic::Vehicle& vehicle) {
  return vehicle.state.position.allFinite() && std::isfinite(vehicle.state.heading) &&
         std::isfinite(vehicle.state.elevation);
}

}  // namespace

rendering::FrontCamera cameraForPeople(const session::SessionSetup& setup, std::int64_t width,
                                       std::int64_t height) {
  rendering::CameraOptions options = setup.options().camera;
  options.width = width;
  options.height = height;
  options.blind = false;
  return {options, setup.network()};
}

FrontViewLog::FrontViewLog(const session::SessionSetup& setup)
    : setup_(setup), ticks_per_view_(ticksPerView(setup.options())) {}

void FrontViewLog::observe(const traffic::TrafficSnapshot& snapshot) {
  if (ticks_per_view_ == 0 || snapshot.tick % ticks_per_view_ != 0) return;
  for (const traffic::Vehicle& vehicle : snapshot.vehicles) {
    if (vehicle.role == traffic::VehicleRole::kBackground) break;  // ego first, then CBVs
    if (vehicle.role != traffic::VehicleRole::kCbv || !canBeDrawn(vehicle)) continue;
    if (!camera_) camera_.emplace(cameraForPeople(setup_, kWidth, kHeight));
    views_.push_back({snapshot.tick, snapshot.time, vehicle.cbv_slot, vehicle.id,
                      jpegOf(camera_->render(snapshot, vehicle))});
    bytes_ += views_.back().jpeg.size();
  }
  while (bytes_ > kFrontViewBytes) thinOut();
}

double FrontViewLog::period() const {
  return static_cast<double>(ticks_per_view_) * setup_.options().simulation_step;
}

void FrontViewLog::thinOut() {
  ticks_per_view_ *= 2;
  const auto left_out = [&](const FrontView& view) { return view.tick % ticks_per_view_ != 0; };
  views_.erase(std::remove_if(views_.begin(), views_.end(), left_out), views_.end());
  bytes_ = 0;
  for (const FrontView& view : views_) bytes_ += view.jpeg.size();
}

}  // namespace cdiff::record
