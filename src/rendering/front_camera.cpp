// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "rendering/front_camera.h"

#include <cmath>

#include "core/option_fields.h"
#include "e2e_cdiff/rendering/camera_options.h"

namespace cdiff::rendering {
namespace {

const CameraOptions& validated(const CameraOptions& options) {
  options.validate();
  return options;
}

}  // namespace

void CameraOptions::describe(core::OptionsVisitor& visitor) {
  visitor.integer({"width", "px", "Width of the image."}, width, 1, 4096);
  visitor.integer({"height", "px", "Height of the image."}, height, 1, 4096);
  visitor.number({"field_of_view", "deg", "Horizontal field of view."}, field_of_view, 10.0, 170.0);
  visitor.number({"mount_forward", "m", "Mounting point ahead of the box's center."}, mount_forward,
                 -20.0, 20.0);
  visitor.number({"mount_height", "m", "Mounting point above the road."}, mount_height, 0.2, 10.0);
  visitor.number({"pitch", "deg", "Downward tilt."}, pitch, -45.0, 45.0);
  visitor.number({"far_distance", "m", "Farthest ground and vehicles that are drawn."},
                 far_distance, 5.0, 1000.0);
  visitor.integer({"supersampling", "", "Samples per pixel and axis."}, supersampling, 1, 8);
  visitor.flag({"blind", "", "Whether every pixel is mid-gray, to see what an image is worth."},
               blind);
}

void CameraOptions::validate() const { core::requireRanges(*this, "camera"); }

Intrinsics intrinsicsOf(const CameraOptions& options) { return intrinsicsOf(frontCamera(options)); }

FrontCamera::FrontCamera(const CameraOptions& options, const map::RoadNetwork& network)
    : options_(validated(options)), renderer_(frontRig(options), network) {}

FrontCamera::FrontCamera(const CameraOptions& options, const FrontCamera& other)
    : options_(validated(options)), renderer_(frontRig(options), other.renderer_) {}

traffic::CameraImage FrontCamera::render(const traffic::TrafficSnapshot& snapshot,
                                         const traffic::Vehicle& vehicle) {
  return std::move(renderer_.render(snapshot, vehicle).front().image);
}

}  // namespace cdiff::rendering
