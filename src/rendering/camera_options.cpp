// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/rendering/camera_options.h"

#include <cmath>

#include "core/text.h"
#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::rendering {
namespace {

/// Holds the values against the ranges of `describe`.
class RangeCheck : public core::OptionsVisitor {
 public:
  void number(const core::FieldInfo& info, double& value, double minimum, double maximum) override {
    if (value >= minimum && value <= maximum) return;
    fail(info, core::formatNumber(value), core::formatNumber(minimum), core::formatNumber(maximum));
  }
  void integer(const core::FieldInfo& info, std::int64_t& value, std::int64_t minimum,
               std::int64_t maximum) override {
    if (value >= minimum && value <= maximum) return;
    fail(info, std::to_string(value), std::to_string(minimum), std::to_string(maximum));
  }
  void flag(const core::FieldInfo&, bool&) override {}
  void text(const core::FieldInfo&, std::string&, const std::vector<std::string>&) override {}
  void list(const core::FieldInfo&, std::vector<std::string>&) override {}
  void points(const core::FieldInfo&, std::vector<Eigen::Vector3d>&) override {}
  bool enter(const core::FieldInfo&) override { return true; }
  void leave() override {}

 private:
  [[noreturn]] static void fail(const core::FieldInfo& info, const std::string& value,
                                const std::string& minimum, const std::string& maximum) {
    throw core::InputError(std::string("camera: ") + info.key + " is " + value +
                           ", but must lie in [" + minimum + ", " + maximum + "]");
  }
};

}  // namespace

void CameraOptions::describe(core::OptionsVisitor& visitor) {
  visitor.integer({"width", "px", "Width of the image."}, width, 1, 4096);
  visitor.integer({"height", "px", "Height of the image."}, height, 1, 4096);
  visitor.number({"field_of_view", "deg", "Horizontal field of view."}, field_of_view, 10.0, 170.0);
  visitor.number({"mount_forward", "m", "Mounting point ahead of the box's centre."}, mount_forward,
                 -20.0, 20.0);
  visitor.number({"mount_height", "m", "Mounting point above the road."}, mount_height, 0.2, 10.0);
  visitor.number({"pitch", "deg", "Downward tilt."}, pitch, -45.0, 45.0);
  visitor.number({"far_distance", "m", "Farthest ground and vehicles that are drawn."},
                 far_distance, 5.0, 1000.0);
  visitor.integer({"supersampling", "", "Samples per pixel and axis."}, supersampling, 1, 8);
  visitor.flag({"blind", "", "Whether every pixel is mid-grey, to see what an image is worth."},
               blind);
}

void CameraOptions::validate() const {
  CameraOptions copy = *this;
  RangeCheck check;
  copy.describe(check);
}

Intrinsics intrinsicsOf(const CameraOptions& options) {
  Intrinsics intrinsics;
  const double width = static_cast<double>(options.width);
  intrinsics.focal_length = 0.5 * width / std::tan(options.field_of_view * core::kPi / 360.0);
  intrinsics.center_x = 0.5 * (width - 1.0);
  intrinsics.center_y = 0.5 * (static_cast<double>(options.height) - 1.0);
  return intrinsics;
}

}  // namespace cdiff::rendering
