// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/rendering/camera_options.h"

namespace cdiff::rendering {
namespace {

std::string errorOf(const CameraOptions& options) {
  try {
    options.validate();
  } catch (const core::InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(CameraOptions, DefaultsAreValid) { EXPECT_EQ(errorOf({}), "no error"); }

TEST(CameraOptions, ErrorsNameKeyAndValue) {
  CameraOptions options;
  options.width = 0;
  EXPECT_EQ(errorOf(options),
            "camera option 'width' is 0; expected a whole number in [1, 4096] px");
  options = {};
  options.height = -3;
  EXPECT_EQ(errorOf(options),
            "camera option 'height' is -3; expected a whole number in [1, 4096] px");
  options = {};
  options.field_of_view = 180.0;
  EXPECT_EQ(errorOf(options),
            "camera option 'field_of_view' is 180; expected a number in [10, 170] deg");
  options = {};
  options.supersampling = 0;
  EXPECT_EQ(errorOf(options),
            "camera option 'supersampling' is 0; expected a whole number in [1, 8]");
  options = {};
  options.far_distance = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(errorOf(options),
            "camera option 'far_distance' is nan; expected a number in [5, 1000] m");
}

TEST(CameraOptions, LoadsFromYaml) {
  CameraOptions options;
  core::loadOptions({"test.yaml", "width: 320\npitch: 2.5\n"}, options);
  EXPECT_EQ(options.width, 320);
  EXPECT_EQ(options.pitch, 2.5);
  EXPECT_EQ(options.height, 96);
}

TEST(Intrinsics, FocalLengthAndCenter) {
  // tan(45 deg) = 1, so f = 160 / 2.
  const Intrinsics intrinsics = intrinsicsOf({});
  EXPECT_NEAR(intrinsics.focal_length, 80.0, 1e-12);
  EXPECT_EQ(intrinsics.center_x, 79.5);
  EXPECT_EQ(intrinsics.center_y, 47.5);
  // tan(30 deg) = 1 / sqrt(3).
  CameraOptions narrow;
  narrow.field_of_view = 60.0;
  EXPECT_NEAR(intrinsicsOf(narrow).focal_length, 80.0 * std::sqrt(3.0), 1e-9);
}

}  // namespace
}  // namespace cdiff::rendering
