// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "e2e_cdiff/core/random.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"
#include "e2e_cdiff/traffic/vehicle.h"
#include "learning/samples/dataset.h"

namespace cdiff::learning {

/// Why a sample's vehicle stops or stands still; the numbers are those of the shard files.
enum StopReason : std::uint8_t {
  kStopNone = 0,
  kStopLight = 1,
  kStopLeader = 2,
  kStopYielding = 3,
  kStopOther = 4
};

/// By DrivingSample::maneuver.
inline constexpr std::array<const char*, 4> kManeuvers = {"straight", "left", "right", "other"};

/// The samples that collection records: one vehicle at one planning time with what it saw, knew and
/// then did. On disk they are samples of named fields (learning/samples/field.h), whose names are
/// those of the struct; planners that need others store others.
struct DrivingSample {
  traffic::CameraImage image;  ///< rgb8; its tick is not stored apart from `tick`
  double speed = 0.0;          ///< own speed at planning time [m/s]
  traffic::Rollout rollout;    ///< [T, 7] metric, body frame at planning time; stored as float32
  std::vector<float> route;    ///< [route_points, 2] tokens (diffusion/network/architecture.h)
  std::uint64_t session = 0;   ///< core::hashText of the session's name; splits are by session
  std::string vehicle;         ///< id
  std::uint64_t tick = 0;      ///< planning time
  bool recovering = false;     ///< shortly (about 2 s) after a disturbance
  std::uint8_t maneuver = 0;   ///< the collector's, an index of kManeuvers
  std::uint8_t stop_reason = kStopNone;  ///< the collector's StopReason
  std::vector<float> auxiliary;  ///< targets that the schema names, of order 1; NaN: not known
  /// What it saw DrivingSchema::previous_interval before; empty: not known.
  traffic::CameraImage previous_image;
  double target_speed = std::numeric_limits<double>::quiet_NaN();  ///< v* [m/s]; NaN: not known
};

/// What every sample of a data set has in common.
struct DrivingSchema {
  std::int64_t horizon = 32;       ///< T
  std::int64_t image_width = 160;  ///< [px]
  std::int64_t image_height = 96;  ///< [px]
  std::int64_t route_points = 16;  ///< tokens
  double route_spacing = 3.0;      ///< [m]
  std::vector<std::string>
      auxiliary;  ///< names of the auxiliary targets; "..._left" changes sign in a mirror
  double previous_interval = 0.0;  ///< of the image before [s]; 0: none is stored
  bool target_speeds = false;      ///< whether the samples say how fast the driver wanted to drive

  /// Throws InputError naming the first part of `sample` that does not fit or is not finite.
  void check(const DrivingSample& sample) const;
  /// From JSON text; throws InputError naming `source` and the key that is missing or wrong.
  static DrivingSchema fromJson(const std::string& text, const std::string& source);
  /// The fields that such samples are stored as.
  SampleSchema fields() const;
  /// From stored fields, which may be more; throws InputError naming `source` and the field that is
  /// missing or another than these samples have.
  static DrivingSchema fromFields(const SampleSchema& stored, const std::string& source);
};

/// The names of the fields that all driving samples have: those of DrivingSchema().fields().
std::vector<std::string> drivingFields();

bool operator==(const DrivingSchema& left, const DrivingSchema& right);

/// Writes driving samples as a shard.
class DrivingShardWriter {
 public:
  explicit DrivingShardWriter(const DrivingSchema& schema)
      : schema_(schema), writer_(schema.fields()) {}

  /// Throws InputError when the sample does not fit the schema.
  void append(const DrivingSample& sample);
  std::size_t size() const { return writer_.size(); }
  /// As ShardWriter::write.
  void write(const std::filesystem::path& path,
             const std::map<std::string, std::string>& facts = {}) {
    writer_.write(path, facts);
  }

 private:
  DrivingSchema schema_;
  ShardWriter writer_;
};

/// A stored data set as driving samples; views `stored`, which must outlive it.
class DrivingDataset {
 public:
  /// Throws InputError naming the field that the data lack.
  explicit DrivingDataset(const Dataset& stored);

  const Dataset& stored() const { return stored_; }
  const DrivingSchema& schema() const { return schema_; }
  std::size_t size() const { return stored_.size(); }
  DrivingSample sample(std::size_t index) const;
  /// With no image, nor that before.
  DrivingSample withoutImage(std::size_t index) const;
  const std::vector<std::size_t>& training() const { return stored_.training(); }
  const std::vector<std::size_t>& validation() const { return stored_.validation(); }

 private:
  const Dataset& stored_;
  DrivingSchema schema_;
};

// Driving samples changed for training: mirrored, or in another light.

/// y, heading and steer change sign.
void mirrorRollout(traffic::Rollout& rollout);

/// Left and right exchanged: images, y, heading, steer, y of the route, and the auxiliary targets
/// whose name in `schema` ends in "_left"; targets "A_left_B" and "A_right_B" change places.
void mirrorSample(const DrivingSchema& schema, DrivingSample& sample);

/// Brightness by up to 40 of 255 gray levels, contrast by up to 20 %, and noise of up to 12 gray
/// levels on each value, in place. Images of another `frame` get the same light and other noise.
void changeLight(const core::RandomStream& random, const core::RandomKey& key,
                 traffic::CameraImage& image, std::uint32_t frame = 0);

}  // namespace cdiff::learning
