// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "e2e_cdiff/traffic/traffic_snapshot.h"
#include "rendering/front_camera.h"
#include "session/session_setup.h"

namespace cdiff::record {

// Camera images inside a page that needs nothing from outside: "data:image/png;base64,..." without
// loss, JPEG where there are many.

/// Whether the image has pixels, as many bytes as its size says.
bool isWhole(const traffic::CameraImage& image);

/// Throws InputError when the image is not whole.
std::string pngDataUri(const traffic::CameraImage& image);

/// JPEG (JFIF), 4:2:0. Throws InputError when the image is not whole.
std::vector<std::uint8_t> jpegOf(const traffic::CameraImage& image);

/// RFC 4648, padded, one line.
std::string base64(const std::vector<std::uint8_t>& bytes);

/// All views of a session take at most this much [bytes]; as text a third more.
inline constexpr std::size_t kFrontViewBytes = 2'400'000;

/// The front view of a slot's vehicle at one tick, as JPEG.
struct FrontView {
  std::uint64_t tick = 0;
  double time = 0.0;  ///< [s]
  int slot = 0;
  std::string vehicle_id;
  std::vector<std::uint8_t> jpeg;
};

/// The camera of the planners with `width` x `height` pixels.
rendering::FrontCamera cameraForPeople(const session::SessionSetup& setup, std::int64_t width,
                                       std::int64_t height);

/// The front view of each CBV through the session, drawn for people: 320 x 192 pixels, JPEG, evenly
/// spaced in time, as many as a fixed number of bytes holds.
class FrontViewLog {
 public:
  /// `setup` must outlive the log. Its report.front_view_rate 0 keeps the log empty.
  explicit FrontViewLog(const session::SessionSetup& setup);
  /// Every tick in order. Vehicles whose state is not finite are passed over.
  void observe(const traffic::TrafficSnapshot& snapshot);

  /// By time, then slot.
  const std::vector<FrontView>& views() const { return views_; }
  /// Between views: as asked for, or a power of two of it where they would not fit [s].
  double period() const;

 private:
  void thinOut();

  const session::SessionSetup& setup_;
  std::uint64_t ticks_per_view_ = 0;              ///< 0: none are wanted
  std::optional<rendering::FrontCamera> camera_;  ///< made when the first CBV is driven
  std::vector<FrontView> views_;
  std::size_t bytes_ = 0;
};

}  // namespace cdiff::record
