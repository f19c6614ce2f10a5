// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "planners/diffusion/image_watch.h"

namespace cdiff::planners {
namespace {

/// Of 2 x 2 pixels, each of its own color.
traffic::CameraImage imageOf(std::uint64_t tick, std::uint8_t first = 0) {
  return {2, 2, tick, {first, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}};
}

/// A vehicle whose images may stay as they are for half a second.
class Watch {
 public:
  /// The fault at a tick and place, "" for none.
  std::string at(std::uint64_t tick, double x, const traffic::CameraImage& image) {
    traffic::VehicleState state;
    state.position.x() = x;
    return watch_.fault({2, 2, 0.5, 0.05}, &image, state, tick).value_or("");
  }
  std::string at(std::uint64_t tick, double x) { return at(tick, x, imageOf(tick)); }

 private:
  ImageWatch watch_;
};

// Half a second is ten ticks, and the view must have changed after one meter.
TEST(ImageWatch, AFrozenImageIsAFaultAfterItsTimeAndOneMeter) {
  Watch watch;
  EXPECT_EQ(watch.at(20, 5.0), "");
  EXPECT_EQ(watch.at(28, 6.5), "") << "0.4 s";
  EXPECT_EQ(watch.at(30, 5.9), "") << "0.9 m";
  EXPECT_EQ(watch.at(30, 6.1),
            "the image has not changed since tick 20 although the vehicle moved 1.1 m");
}

TEST(ImageWatch, AnotherImageStartsTheTimeAndTheWayAgain) {
  Watch watch;
  EXPECT_EQ(watch.at(20, 5.0), "");
  EXPECT_EQ(watch.at(26, 7.0, imageOf(26, 99)), "");
  EXPECT_EQ(watch.at(34, 9.0, imageOf(34, 99)), "") << "0.4 s since then";
  EXPECT_EQ(watch.at(36, 7.9, imageOf(36, 99)), "") << "0.9 m since then";
  EXPECT_EQ(watch.at(36, 8.1, imageOf(36, 99)),
            "the image has not changed since tick 26 although the vehicle moved 1.1 m");
}

// Rows of one color each, of which no two are alike, are sky and ground.
TEST(ImageWatch, SkyAndGroundAreNoSignOfAFrozenCamera) {
  Watch watch;
  for (const std::uint64_t tick : {0U, 20U}) {
    const double x = static_cast<double>(tick);
    EXPECT_EQ(watch.at(tick, x, {2, 2, tick, {1, 2, 3, 1, 2, 3, 4, 5, 6, 4, 5, 6}}), "");
  }
  EXPECT_EQ(watch.at(30, 30.0, {2, 2, 30, {1, 2, 3, 1, 2, 3, 1, 2, 3, 1, 2, 3}}), "");
  EXPECT_NE(watch.at(40, 40.0, {2, 2, 40, {1, 2, 3, 1, 2, 3, 1, 2, 3, 1, 2, 3}}), "")
      << "one color";
}

TEST(ImageWatch, SizesBytesAndTicksAreChecked) {
  Watch watch;
  EXPECT_EQ(watch.at(4, 0.0, imageOf(2)), "the image is of tick 2; expected tick 4");
  traffic::CameraImage image = imageOf(4);
  image.rgb.pop_back();
  EXPECT_EQ(watch.at(4, 0.0, image), "the image is 2 x 2 with 11 bytes; expected 2 x 2 rgb8");
  image = imageOf(4);
  image.width = 4;
  image.height = 1;
  EXPECT_EQ(watch.at(4, 0.0, image), "the image is 4 x 1 with 12 bytes; expected 2 x 2 rgb8");
  EXPECT_EQ(watch.at(4, 0.0, {}), "no image came for tick 4");
}

}  // namespace
}  // namespace cdiff::planners
