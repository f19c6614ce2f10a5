// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "e2e_cdiff/traffic/traffic_snapshot.h"
#include "e2e_cdiff/traffic/vehicle.h"

namespace cdiff::planners {

/// "160 x 96", of a picture [px].
std::string sizeText(std::int64_t width, std::int64_t height);

/// What is expected of every image.
struct ImageExpectation {
  int width = 160;                 ///< [px]
  int height = 96;                 ///< [px]
  double frozen_image_time = 1.0;  ///< [s]
  double simulation_step = 0.05;   ///< [s]
};

/// Whether a vehicle's images can be driven by: right size, of this tick, and not frozen while the
/// vehicle moves. A view of sky and ground alone may stay as it is.
/// One per vehicle; asked once per decision.
class ImageWatch {
 public:
  /// What is wrong with `image` (nullptr: none came) for a decision at `tick`; nullopt when
  /// nothing.
  std::optional<std::string> fault(const ImageExpectation& expectation,
                                   const traffic::CameraImage* image,
                                   const traffic::VehicleState& state, std::uint64_t tick);
  /// Hash of the last image that was looked at; 0 before the first.
  std::uint64_t imageHash() const { return hash_; }

 private:
  bool frozen(const ImageExpectation& expectation, const traffic::CameraImage& image,
              const traffic::VehicleState& state, std::uint64_t tick);

  std::uint64_t hash_ = 0;  ///< of the image seen since `since_tick_`
  std::uint64_t since_tick_ = 0;
  Eigen::Vector2d since_position_ = Eigen::Vector2d::Zero();
  bool seen_ = false;
};

}  // namespace cdiff::planners
