// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// What the planner learns from: one vehicle at one planning time with what it saw, knew and then
/// did.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "e2e_cdiff/traffic/camera_image.h"
#include "e2e_cdiff/traffic/rollout.h"

namespace cdiff::training {

/// Why a sample's vehicle comes to stand or stands; numbers are those of the shard files.
enum StopReason : std::uint8_t {
  kStopNone = 0,
  kStopLight = 1,
  kStopLeader = 2,
  kStopYielding = 3,
  kStopOther = 4
};

struct Sample {
  traffic::CameraImage image;  ///< rgb8; its tick is not stored apart from `tick`
  double speed = 0.0;          ///< own speed at planning time [m/s]
  traffic::Rollout rollout;    ///< [T, 7] metric, body frame at planning time; stored as float32
  std::vector<float> route;    ///< [route_points, 2] tokens (diffusion/route_tokens.h)
  std::uint64_t session = 0;   ///< core::hashText of the session's name; splits are by session
  std::string vehicle;         ///< id
  std::uint64_t tick = 0;      ///< planning time
  bool recovering = false;     ///< shortly (about 2 s) after a disturbance
  std::uint8_t maneuver = 0;   ///< of the collector: 0 straight on, 1 left, 2 right, 3 other
  std::uint8_t stop_reason = kStopNone;  ///< of the collector: a StopReason
  std::vector<float> auxiliary;  ///< targets that the schema names, of order 1; NaN: not known
};

/// What every sample of a data set has in common.
struct SampleSchema {
  std::int64_t horizon = 32;       ///< T
  std::int64_t image_width = 160;  ///< [px]
  std::int64_t image_height = 96;  ///< [px]
  std::int64_t route_points = 16;  ///< tokens
  double route_spacing = 3.0;      ///< [m]
  std::vector<std::string>
      auxiliary;  ///< names of the auxiliary targets; "..._left" changes sign in a mirror

  /// Throws InputError naming the first field of `sample` that does not fit or is not finite.
  void check(const Sample& sample) const;
  /// As JSON text and back; throws InputError naming `source` and the key that is missing or wrong.
  std::string toJson() const;
  static SampleSchema fromJson(const std::string& text, const std::string& source);
};

bool operator==(const SampleSchema& left, const SampleSchema& right);

}  // namespace cdiff::training
