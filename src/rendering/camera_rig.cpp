// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/rendering/camera_rig.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/option_fields.h"
#include "core/registry.h"
#include "core/text.h"
#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::rendering {
namespace {

using core::InputError;

/// Bench2Drive's cameras (x forward, y left, yaw counter-clockwise), those of the front first.
std::vector<RigCamera> bench2driveCameras() {
  return {{"front", 0.80, 0.0, 1.60, 0.0, 0.0, 70.0},
          {"front_left", 0.27, 0.55, 1.60, 55.0, 0.0, 70.0},
          {"front_right", 0.27, -0.55, 1.60, -55.0, 0.0, 70.0},
          {"back", -2.0, 0.0, 1.60, 180.0, 0.0, 110.0},
          {"back_left", -0.32, 0.55, 1.60, 110.0, 0.0, 70.0},
          {"back_right", -0.32, -0.55, 1.60, -110.0, 0.0, 70.0}};
}

std::vector<RigCamera> presetCameras(const std::string& preset) {
  std::vector<RigCamera> cameras = bench2driveCameras();
  if (preset == kFrontThreeRig) cameras.resize(3);
  return cameras;
}

/// A camera's values by key, as its description names them.
std::map<std::string, std::string> valuesOf(const RigCamera& camera) {
  return core::flatOptions(camera);
}

void requireNames(const std::vector<RigCamera>& cameras, const std::string& place) {
  std::set<std::string> seen;
  for (const RigCamera& camera : cameras) {
    const std::string subject = place + "camera '" + core::shortened(camera.name) + "'";
    if (!core::isSnakeCase(camera.name))
      throw InputError(subject + ": its name (key 'name') must be snake_case");
    if (!seen.insert(camera.name).second)
      throw InputError(subject + ": another camera of the rig has this name (key 'name')");
  }
}

void requireValid(const std::vector<RigCamera>& cameras, const std::string& place) {
  if (cameras.empty()) throw InputError(place + "the rig has no camera; expected at least one");
  if (cameras.size() > kMostCameras) {
    throw InputError(place + "the rig has " + std::to_string(cameras.size()) +
                     " cameras; expected at most " + std::to_string(kMostCameras));
  }
  requireNames(cameras, place);
  for (const RigCamera& camera : cameras)
    core::requireRanges(camera, place + "camera '" + camera.name + "':");
}

std::string rigText(const CameraRig& rig, const RigUse& use) {
  return "the rig of key '" + use.key + "' has " + core::joinText(rig.names(), ", ");
}

}  // namespace

void RigCamera::describe(core::OptionsVisitor& visitor) {
  visitor.text({"name", "", "Name of the camera, unique in its rig."}, name, {});
  visitor.number({"x", "m", "Mounting point ahead of the box's center."}, x, -20.0, 20.0);
  visitor.number({"y", "m", "Mounting point left of the box's center."}, y, -20.0, 20.0);
  visitor.number({"z", "m", "Mounting point above the road."}, z, 0.2, 10.0);
  visitor.number({"yaw", "deg", "Direction, counter-clockwise from forward."}, yaw, -180.0, 180.0);
  visitor.number({"pitch", "deg", "Downward tilt."}, pitch, -45.0, 45.0);
  visitor.number({"field_of_view", "deg", "Horizontal field of view."}, field_of_view, 10.0, 170.0);
  visitor.integer({"width", "px", "Width of the image."}, width, 1, 4096);
  visitor.integer({"height", "px", "Height of the image."}, height, 1, 4096);
}

void CameraRig::describe(core::OptionsVisitor& visitor) {
  visitor.groups({"cameras", "", "Cameras in the order of their images."}, cameras);
  visitor.number({"far_distance", "m", "Farthest ground and vehicles that are drawn."},
                 far_distance, 5.0, 1000.0);
  visitor.integer({"supersampling", "", "Samples per pixel and axis."}, supersampling, 1, 8);
  visitor.flag({"blind", "", "Whether every pixel is mid-gray."}, blind);
}

void CameraRig::validate() const {
  requireValid(cameras, "");
  core::requireRanges(*this, "camera rig");
}

const RigCamera* CameraRig::find(const std::string& name) const {
  const auto found = std::find_if(cameras.begin(), cameras.end(),
                                  [&](const RigCamera& camera) { return camera.name == name; });
  return found == cameras.end() ? nullptr : &*found;
}

std::vector<std::string> CameraRig::names() const {
  std::vector<std::string> names;
  for (const RigCamera& camera : cameras) names.push_back(camera.name);
  return names;
}

const std::vector<std::string>& rigPresets() {
  static const std::vector<std::string> presets = {kFrontRig, kFrontThreeRig, kBench2driveRig};
  return presets;
}

void RigOptions::describe(core::OptionsVisitor& visitor) {
  std::vector<std::string> presets = rigPresets();
  presets.insert(presets.begin(), kPlannersRig);
  presets.emplace_back(kOwnRig);
  visitor.text({"preset", "", "Which cameras: those that the planner names, a preset, or own."},
               preset, presets);
  visitor.integer({"width", "px", "Width of a preset's images; 0: camera.width."}, width, 0, 4096);
  visitor.integer({"height", "px", "Height of a preset's images; 0: camera.height."}, height, 0,
                  4096);
  visitor.groups({"cameras", "", "The cameras of the preset own."}, cameras);
}

void RigOptions::validate(const std::string& group) const {
  const std::string key = "key '" + group + "cameras'";
  if (preset != kOwnRig && !cameras.empty()) {
    throw InputError(key + " lists cameras, but '" + group + "preset' is '" + preset +
                     "'; expected the preset 'own' or no list");
  }
  if (preset == kOwnRig && (width != 0 || height != 0)) {
    throw InputError("keys '" + group + "width' and '" + group +
                     "height' are the size of a preset's images; the cameras of the preset 'own' "
                     "have their own width and height");
  }
  if (preset == kOwnRig) requireValid(cameras, key + ": ");
}

RigCamera frontCamera(const CameraOptions& options) {
  return {kFrontCamera,  options.mount_forward, 0.0,           options.mount_height, 0.0,
          options.pitch, options.field_of_view, options.width, options.height};
}

CameraRig frontRig(const CameraOptions& options) {
  return {{frontCamera(options)}, options.far_distance, options.supersampling, options.blind};
}

CameraRig rigOf(const RigOptions& options, const CameraOptions& camera,
                const std::string& planners_rig) {
  CameraRig rig = frontRig(camera);
  const std::string& preset = options.preset == kPlannersRig ? planners_rig : options.preset;
  if (preset == kOwnRig) {
    rig.cameras = options.cameras;
    return rig;
  }
  if (preset != kFrontRig) rig.cameras = presetCameras(preset);
  for (RigCamera& one : rig.cameras) {
    one.width = options.width != 0 ? options.width : camera.width;
    one.height = options.height != 0 ? options.height : camera.height;
  }
  return rig;
}

Intrinsics intrinsicsOf(const RigCamera& camera) {
  Intrinsics intrinsics;
  const double width = static_cast<double>(camera.width);
  intrinsics.focal_length = 0.5 * width / std::tan(camera.field_of_view * core::kPi / 360.0);
  intrinsics.center_x = 0.5 * (width - 1.0);
  intrinsics.center_y = 0.5 * (static_cast<double>(camera.height) - 1.0);
  return intrinsics;
}

Eigen::Matrix<double, 3, 4> cameraFromVehicle(const RigCamera& camera) {
  const double yaw = camera.yaw * core::kDegree;
  const double pitch = camera.pitch * core::kDegree;
  const Eigen::Vector3d level(std::cos(yaw), std::sin(yaw), 0.0);
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  Eigen::Matrix<double, 3, 4> matrix;
  matrix.row(0).head<3>() << std::sin(yaw), -std::cos(yaw), 0.0;
  matrix.row(1).head<3>() = -std::sin(pitch) * level - std::cos(pitch) * up;
  matrix.row(2).head<3>() = std::cos(pitch) * level - std::sin(pitch) * up;
  matrix.col(3) = -(matrix.leftCols<3>() * Eigen::Vector3d(camera.x, camera.y, camera.z));
  return matrix;
}

Eigen::Matrix<double, 3, 4> projectionOf(const RigCamera& camera) {
  const Intrinsics intrinsics = intrinsicsOf(camera);
  Eigen::Matrix3d matrix;
  matrix << intrinsics.focal_length, 0.0, intrinsics.center_x,  //
      0.0, intrinsics.focal_length, intrinsics.center_y,        //
      0.0, 0.0, 1.0;
  return matrix * cameraFromVehicle(camera);
}

void requireCameras(const CameraRig& rig, const std::vector<std::string>& cameras,
                    const RigUse& use) {
  for (const std::string& name : cameras) {
    if (rig.find(name) != nullptr) continue;
    throw InputError(use.user + " needs the camera '" + name + "'; " + rigText(rig, use) +
                     "; expected a preset or own cameras that hold it");
  }
}

void requireSameCameras(const CameraRig& rig, const std::vector<RigCamera>& trained,
                        const RigUse& use) {
  std::vector<std::string> names;
  for (const RigCamera& camera : trained) names.push_back(camera.name);
  requireCameras(rig, names, use);
  for (const RigCamera& wanted : trained) {
    const auto given = valuesOf(*rig.find(wanted.name));
    for (const auto& [key, value] : valuesOf(wanted)) {
      if (given.at(key) == value) continue;
      throw InputError("camera '" + wanted.name + "' of the rig of key '" + use.key + "' has " +
                       key + " " + given.at(key) + "; " + use.user + " was trained with " + value);
    }
  }
}

}  // namespace cdiff::rendering
