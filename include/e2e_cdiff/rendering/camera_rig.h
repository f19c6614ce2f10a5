// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "e2e_cdiff/core/options.h"
#include "e2e_cdiff/rendering/camera_options.h"

namespace cdiff::rendering {

/// One camera of a rig: pinhole, optical frame x right, y down, z forward, rgb8; mounted in the
/// vehicle's frame (x forward, y left, z up [m] from the road below the box's center).
struct RigCamera {
  std::string name = "front";   ///< snake_case, unique in its rig
  double x = 0.5;               ///< forward [m]
  double y = 0.0;               ///< left [m]
  double z = 1.4;               ///< up [m]
  double yaw = 0.0;             ///< counter-clockwise from forward, so that 90 looks left [deg]
  double pitch = 0.0;           ///< downwards [deg]
  double field_of_view = 90.0;  ///< horizontal [deg]
  std::int64_t width = 160;     ///< [px]
  std::int64_t height = 96;     ///< [px]

  void describe(core::OptionsVisitor& visitor);  ///< visits every option
};

/// The cameras of one vehicle and what they share. The order of the cameras is that of every list
/// of its images.
struct CameraRig {
  std::vector<RigCamera> cameras;  ///< at least one
  double far_distance = 90.0;      ///< farthest ground and vehicles that are drawn [m]
  std::int64_t supersampling = 2;  ///< samples per pixel and axis
  bool blind = false;              ///< every pixel mid-gray

  void describe(core::OptionsVisitor& visitor);  ///< visits every option
  /// Throws InputError naming camera and key: no camera, more than kMostCameras, a name that is
  /// repeated or not snake_case, a value out of range.
  void validate() const;
  /// The camera with this name, or nullptr.
  const RigCamera* find(const std::string& name) const;
  /// Names of the cameras, in their order.
  std::vector<std::string> names() const;
};

inline constexpr std::size_t kMostCameras = 16;
/// Name of the camera whose topics are those of a vehicle with one camera.
inline constexpr const char* kFrontCamera = "front";

// Presets of rigs, by name.
inline constexpr const char* kFrontRig = "front";                  ///< the front camera alone
inline constexpr const char* kFrontThreeRig = "front_three";       ///< Bench2Drive's front three
inline constexpr const char* kBench2driveRig = "bench2drive_six";  ///< Bench2Drive's six
inline constexpr const char* kPlannersRig = "planner";             ///< as the planner says
inline constexpr const char* kOwnRig = "own";                      ///< the listed cameras

/// The names of presets that are rigs by themselves: front, front_three, bench2drive_six.
const std::vector<std::string>& rigPresets();

/// Which cameras a vehicle has: a preset, or cameras of the user's own.
struct RigOptions {
  std::string preset = kPlannersRig;  ///< name of a preset (above)
  std::int64_t width = 0;             ///< of a preset's images [px]; 0: camera.width
  std::int64_t height = 0;            ///< [px]; 0: camera.height
  std::vector<RigCamera> cameras;     ///< of preset "own"

  void describe(core::OptionsVisitor& visitor);  ///< visits every option
  /// Throws InputError naming the key after `group` ("ego_rig."): cameras listed without the preset
  /// "own" or none with it, a size beside the preset "own", and what CameraRig::validate refuses.
  void validate(const std::string& group) const;
};

/// The front camera of CameraOptions as a camera of a rig.
RigCamera frontCamera(const CameraOptions& options);
/// A rig of that camera alone.
CameraRig frontRig(const CameraOptions& options);

/// The rig that options mean; far distance, supersampling, blindness and sizes that are not given
/// are those of `camera`. `planners_rig`: the preset that stands for "planner".
CameraRig rigOf(const RigOptions& options, const CameraOptions& camera,
                const std::string& planners_rig = kFrontRig);

/// f = width / 2 / tan(field_of_view / 2); center ((width - 1) / 2, (height - 1) / 2).
Intrinsics intrinsicsOf(const RigCamera& camera);
/// Rotation and translation [R | t] from the vehicle's frame into the optical frame [m]: rows are
/// the directions right, down and forward.
Eigen::Matrix<double, 3, 4> cameraFromVehicle(const RigCamera& camera);
/// Intrinsics x [R | t]: a point (x, y, z, 1) of the vehicle's frame [m] to (u w, v w, w), with
/// the pixel (u, v) and the depth w [m].
Eigen::Matrix<double, 3, 4> projectionOf(const RigCamera& camera);

/// Who works with which cameras, for errors.
struct RigUse {
  std::string user;  ///< "ego_planner 'vad_mini'"
  std::string key;   ///< of the rig's options: "ego_rig"
};

/// Throws InputError naming user, camera and key where `rig` lacks one of the cameras.
void requireCameras(const CameraRig& rig, const std::vector<std::string>& cameras,
                    const RigUse& use);
/// The same, and where a camera has another position, direction, field of view or size than that of
/// the same name in `trained`, which the weights of `use.user` were trained with.
void requireSameCameras(const CameraRig& rig, const std::vector<RigCamera>& trained,
                        const RigUse& use);

}  // namespace cdiff::rendering
