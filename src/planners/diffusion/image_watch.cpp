// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/diffusion/image_watch.h"

#include <algorithm>
#include <string_view>

#include "core/text.h"
#include "e2e_cdiff/core/random.h"

namespace cdiff::planners {
namespace {

constexpr double kMovedDistance = 1.0;  // [m] after which the view must have changed

/// Whether an image shows sky and ground alone: one color in each row, and not the same in all.
/// Such a view stays as it is while the vehicle moves, and is no sign of a frozen camera.
bool showsNothing(const traffic::CameraImage& image) {
  const std::size_t row_bytes = static_cast<std::size_t>(image.width) * 3;
  bool differs = false;
  for (std::size_t begin = 0; begin < image.rgb.size(); begin += row_bytes) {
    const std::uint8_t* row = image.rgb.data() + begin;
    if (!std::equal(row + 3, row + row_bytes, row)) return false;
    differs = differs || !std::equal(row, row + 3, image.rgb.data());
  }
  return differs;
}

}  // namespace

std::string sizeText(std::int64_t width, std::int64_t height) {
  return std::to_string(width) + " x " + std::to_string(height);
}

std::optional<std::string> ImageWatch::fault(const ImageExpectation& expectation,
                                             const traffic::CameraImage* image,
                                             const traffic::VehicleState& state,
                                             std::uint64_t tick) {
  if (image == nullptr || image->empty()) return "no image came for tick " + std::to_string(tick);
  const auto bytes = static_cast<std::size_t>(expectation.width) *
                     static_cast<std::size_t>(expectation.height) * 3;
  if (image->width != expectation.width || image->height != expectation.height ||
      image->rgb.size() != bytes) {
    return "the image is " + sizeText(image->width, image->height) + " with " +
           std::to_string(image->rgb.size()) + " bytes; expected " +
           sizeText(expectation.width, expectation.height) + " rgb8";
  }
  if (image->tick != tick) {
    return "the image is of tick " + std::to_string(image->tick) + "; expected tick " +
           std::to_string(tick);
  }
  if (!frozen(expectation, *image, state, tick)) return std::nullopt;
  return "the image has not changed since tick " + std::to_string(since_tick_) +
         " although the vehicle moved " +
         core::formatFixed((state.position - since_position_).norm(), 1) + " m";
}

bool ImageWatch::frozen(const ImageExpectation& expectation, const traffic::CameraImage& image,
                        const traffic::VehicleState& state, std::uint64_t tick) {
  const std::uint64_t hash = core::hashText(
      std::string_view(reinterpret_cast<const char*>(image.rgb.data()), image.rgb.size()));
  if (!seen_ || hash != hash_ || showsNothing(image)) {
    seen_ = true;
    hash_ = hash;
    since_tick_ = tick;
    since_position_ = state.position;
    return false;
  }
  const double age = static_cast<double>(tick - since_tick_) * expectation.simulation_step;
  return age >= expectation.frozen_image_time &&
         (state.position - since_position_).norm() >= kMovedDistance;
}

}  // namespace cdiff::planners
