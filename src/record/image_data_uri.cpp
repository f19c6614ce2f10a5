// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "record/image_data_uri.h"

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
  static constexpr char kLetters[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t j = 0; j < 3; ++j) group = group << 8 | (j < count ? bytes[i + j] : 0U);
    for (std::size_t j = 0; j < 4; ++j) {
      text += j <= count ? kLetters[group >> (18 - 6 * j) & 63U] : '=';
    }
  }
  return text;
}

std::string pngDataUri(const traffic::CameraImage& image) {
  return "data:image/png;base64," +
         base64(encoded(image, ".png", {cv::IMWRITE_PNG_COMPRESSION, 9}));
}

std::vector<std::uint8_t> jpegOf(const traffic::CameraImage& image) {
  return encoded(image, ".jpg", {cv::IMWRITE_JPEG_QUALITY, kJpegQuality});
}

}  // namespace cdiff::record
