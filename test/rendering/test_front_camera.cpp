// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "e2e_cdiff/core/exceptions.h"
#include "rendering/camera_worlds.h"
#include "rendering/front_camera.h"

namespace cdiff::rendering {
namespace {

constexpr Pixel kTailLight = {128, 14, 16};
constexpr Pixel kBrakeLight = {255, 36, 24};
constexpr Pixel kRed = {255, 40, 32};
constexpr Pixel kYellow = {255, 208, 24};
constexpr Pixel kGreen = {40, 240, 96};
constexpr Pixel kUnlitRed = {70, 20, 20};

TEST(FrontCamera, ProjectsPointsOfTheMap) {
  const RigCamera camera = frontCamera(levelCamera());
  // Eye (0.5, 0, 1.4): depth 20, 2 m left, 1.4 m down: u = 79.5 - 80 * 2 / 20, v = 47.5 + 80 * 1.4
  // / 20.
  const auto pixel = pixelOf(camera, vehicleAt("ego", 0.0, 0.0), {20.5, 2.0, 0.0});
  ASSERT_TRUE(pixel);
  EXPECT_NEAR(pixel->x(), 71.5, 1e-9);
  EXPECT_NEAR(pixel->y(), 53.1, 1e-9);
  EXPECT_FALSE(pixelOf(camera, vehicleAt("ego", 0.0, 0.0), {-20.5, 2.0, 0.0}));
}

TEST(FrontCamera, ABlindOneShowsMidGrayAtItsTick) {
  CameraOptions options = levelCamera();
  options.blind = true;
  FrontCamera camera(options, straightRoad());
  traffic::TrafficSnapshot snapshot;
  snapshot.tick = 42;
  snapshot.vehicles = {vehicleAt("ego", 0.0, 0.0), vehicleAt("leader", 12.0, 0.0)};
  const traffic::CameraImage image = camera.render(snapshot, snapshot.vehicles.front());
  EXPECT_EQ(image.tick, 42U);
  EXPECT_EQ(image.width, options.width);
  EXPECT_EQ(image.height, options.height);
  EXPECT_EQ(image.rgb, std::vector<std::uint8_t>(image.rgb.size(), 128));
  ASSERT_EQ(image.rgb.size(), static_cast<std::size_t>(3 * options.width * options.height));
}

/// Pixels whose red, and whose blue, is more than twice their green or not, as asked for.
int countTinted(const traffic::CameraImage& image, bool red, bool blue) {
  int count = 0;
  for (std::size_t i = 0; i + 2 < image.rgb.size(); i += 3) {
    const bool is_red = image.rgb[i] > 2 * image.rgb[i + 1];
    const bool is_blue = image.rgb[i + 2] > 2 * image.rgb[i + 1];
    count += is_red == red && is_blue == blue;
  }
  return count;
}

/// What a vehicle sees of another 12 m ahead in some role.
traffic::CameraImage viewOf(traffic::VehicleRole role, BodyColors colors) {
  FrontCamera camera(levelCamera(), straightRoad());
  camera.setBodyColors(colors);
  traffic::Vehicle other = vehicleAt("other", 12.0, 0.0);
  other.role = role;
  const traffic::Vehicle viewer = vehicleAt("viewer", 0.0, 0.0);
  return camera.render(snapshotOf({viewer, other}), viewer);
}

TEST(FrontCamera, PlannersDoNotSeeWhoAVehicleIs) {
  const auto seen = [](traffic::VehicleRole role) { return viewOf(role, BodyColors::kById).rgb; };
  EXPECT_EQ(seen(traffic::VehicleRole::kEgo), seen(traffic::VehicleRole::kBackground));
  EXPECT_EQ(seen(traffic::VehicleRole::kCbv), seen(traffic::VehicleRole::kBackground));
}

// A box of 1.8 m x 1.5 m at 9.25 m: about 15 x 13 pixels, a third of it glass, lights and tires.
TEST(FrontCamera, PeopleSeeWhoAVehicleIs) {
  constexpr int kLeast = 40;
  const auto seen = [](traffic::VehicleRole role) { return viewOf(role, BodyColors::kByRole); };
  EXPECT_GT(countTinted(seen(traffic::VehicleRole::kEgo), true, false), kLeast);
  EXPECT_GT(countTinted(seen(traffic::VehicleRole::kCbv), true, true), kLeast);
  EXPECT_EQ(countTinted(seen(traffic::VehicleRole::kBackground), true, true), 0);
}

TEST(FrontCamera, ProjectsFromTheVehiclesPoseAndElevation) {
  const RigCamera camera = frontCamera(levelCamera());
  traffic::Vehicle vehicle = vehicleAt("ego", 100.0, 50.0, 0.5 * 3.14159265358979323846);
  vehicle.state.elevation = 6.0;
  // Heading north, eye (100, 50.5, 7.4): the point lies 10 ahead, 5 right, 0.6 above.
  const auto pixel = pixelOf(camera, vehicle, {105.0, 60.5, 8.0});
  ASSERT_TRUE(pixel);
  EXPECT_NEAR(pixel->x(), 79.5 + 80.0 * 5.0 / 10.0, 1e-9);
  EXPECT_NEAR(pixel->y(), 47.5 - 80.0 * 0.6 / 10.0, 1e-9);
}

TEST(FrontCamera, PitchLowersTheView) {
  CameraOptions options = levelCamera();
  options.pitch = 45.0;
  const RigCamera camera = frontCamera(options);
  // The ray 45 degrees down meets the road 1.4 m ahead of the eye: the principal point.
  const auto pixel = pixelOf(camera, vehicleAt("ego", 0.0, 0.0), {1.9, 0.0, 0.0});
  ASSERT_TRUE(pixel);
  EXPECT_NEAR(pixel->x(), 79.5, 1e-9);
  EXPECT_NEAR(pixel->y(), 47.5, 1e-9);
}

TEST(FrontCamera, RejectsBadOptions) {
  CameraOptions options;
  options.width = 0;
  EXPECT_THROW(FrontCamera(options, straightRoad()), core::InputError);
}

TEST(FrontCamera, PaintsTheStopLineInTheColorOfItsLight) {
  FrontCamera camera(levelCamera(), signaledLane(10.5));
  const traffic::Vehicle ego = vehicleAt("ego", 0.0, 0.0);
  traffic::TrafficSnapshot snapshot = snapshotOf({ego});
  snapshot.signals = {{"light", "Gr"}};  // link 1 is red
  const traffic::CameraImage image = camera.render(snapshot, ego);
  // The line lies at depths 9.5 to 10, 1.4 m down: rows 47.5 + 112 / 10 = 58.7 to 47.5 + 112 / 9.5
  // = 59.29, so both samples of row 59 (58.75 and 59.25) are on it; sideways 1.9 m at
  // depth 9.75: 15.6 columns.
  for (const int column : {66, 79, 80, 93}) EXPECT_EQ(pixelAt(image, column, 59), kRed) << column;
  for (const int column : {62, 97}) EXPECT_NE(pixelAt(image, column, 59), kRed) << column;
  EXPECT_NE(pixelAt(image, 79, 57), kRed);
  EXPECT_NE(pixelAt(image, 79, 61), kRed);
}

TEST(FrontCamera, LampAndStopLineFollowTheLight) {
  FrontCamera camera(levelCamera(), signaledLane(10.5));
  const traffic::Vehicle ego = vehicleAt("ego", 0.0, 0.0);
  traffic::TrafficSnapshot snapshot = snapshotOf({ego});
  const auto see = [&](const char* state) {
    snapshot.signals = {{"light", state}};
    return camera.render(snapshot, ego);
  };
  // The lamp's middle stands 2.5 m behind the lane's end, depth 12.5, 3.1 m up; bulbs 0.54 m above,
  // at and below it: rows 47.5 - 6.4 * (2.24, 1.7, 1.16) = 33.2, 36.6, 40.1, with radius 1.5.
  EXPECT_EQ(pixelAt(see("rr"), 79, 33), kRed);
  EXPECT_EQ(pixelAt(see("ry"), 79, 36), kYellow);
  EXPECT_EQ(pixelAt(see("rG"), 79, 40), kGreen);
  EXPECT_EQ(pixelAt(see("rg"), 79, 40), kGreen);
  EXPECT_EQ(pixelAt(see("rG"), 79, 33), kUnlitRed);
  EXPECT_EQ(pixelAt(see("rO"), 79, 33), kUnlitRed);  // off
  EXPECT_EQ(pixelAt(see("r"), 79, 33), kUnlitRed);   // the state lacks the link
  EXPECT_EQ(pixelAt(see("rG"), 79, 59), kGreen);
}

TEST(FrontCamera, PaintsAVehicleWhereItIs) {
  FrontCamera camera(levelCamera(), straightRoad());
  const traffic::Vehicle ego = vehicleAt("ego", 0.0, 0.0);
  // Its rear face is at depth 12.75 - 2.25 - 0.5 = 10; 0.9 m to each side are 7.2 columns: 72.3 to
  // 86.7, so columns 73 to 86 lie inside; row 56 sees heights 0.31 to 0.37: body, below the lights.
  const auto image = camera.render(snapshotOf({ego, vehicleAt("other", 12.75, 0.0)}), ego);
  const auto empty = camera.render(snapshotOf({ego}), ego);
  for (int column = 73; column <= 86; ++column) {
    EXPECT_EQ(pixelAt(image, column, 56), pixelAt(image, 79, 56)) << column;
    EXPECT_NE(pixelAt(image, column, 56), pixelAt(empty, column, 56)) << column;
  }
  for (const int column : {72, 87}) {
    EXPECT_EQ(pixelAt(image, column, 56), pixelAt(empty, column, 56)) << column;
  }
}

// Feet at depth 10 are at row 47.5 + 80 * 1.4 / 10 = 58.7, and the head ends at 47.5 - 3.2 = 44.3.
// Shoulders reach 0.3 m to each side: 2.4 columns.
TEST(FrontCamera, APedestrianStandsUprightWithoutLights) {
  FrontCamera camera(levelCamera(), straightRoad());
  const traffic::Vehicle ego = vehicleAt("ego", 0.0, 0.0);
  traffic::Vehicle walker = vehicleAt("walker", 10.7, 0.0);
  walker.dimensions = {0.4, 0.6, 1.8};
  walker.state.speed = 0.0;  // a vehicle would show brake lights
  const auto image = camera.render(snapshotOf({ego, walker}), ego);
  const auto empty = camera.render(snapshotOf({ego}), ego);
  for (const int row : {45, 50, 57}) EXPECT_NE(pixelAt(image, 79, row), pixelAt(empty, 79, row));
  EXPECT_NE(pixelAt(image, 79, 50), pixelAt(image, 79, 57));  // body and legs
  for (const int row : {42, 60}) EXPECT_EQ(pixelAt(image, 79, row), pixelAt(empty, 79, row));
  for (const int column : {75, 84})
    EXPECT_EQ(pixelAt(image, column, 50), pixelAt(empty, column, 50)) << column;
  for (int row = 44; row < 59; ++row)
    for (int column = 76; column < 84; ++column)
      EXPECT_NE(pixelAt(image, column, row), kBrakeLight) << column << " " << row;
}

TEST(FrontCamera, TailLightsBecomeBrakeLights) {
  FrontCamera camera(levelCamera(), straightRoad());
  const traffic::Vehicle ego = vehicleAt("ego", 0.0, 0.0);
  const auto light = [&](const traffic::Vehicle& other) {
    const auto image = camera.render(snapshotOf({ego, other}), ego);
    EXPECT_EQ(pixelAt(image, 74, 53), pixelAt(image, 85, 53));
    return pixelAt(image, 85, 53);
  };
  // Lights lie 0.495 to 0.873 m from the middle, 0.51 to 0.81 m high; at depth 10: columns 79.5 +-
  // (4.0 to 7.0), rows 52.2 to 54.6.
  traffic::Vehicle other = vehicleAt("other", 12.75, 0.0);
  EXPECT_EQ(light(other), kTailLight);
  other.acceleration = -0.4;
  EXPECT_EQ(light(other), kTailLight);
  other.acceleration = -0.6;
  EXPECT_EQ(light(other), kBrakeLight);
  other.acceleration = 0.0;
  other.applied_action = traffic::ControlAction{0.0, 0.0, 0.05};
  EXPECT_EQ(light(other), kTailLight);
  other.applied_action->brake = 0.2;
  EXPECT_EQ(light(other), kBrakeLight);
  other.applied_action.reset();
  other.state.speed = 0.0;
  EXPECT_EQ(light(other), kBrakeLight);
}

TEST(FrontCamera, FrontAndRearDiffer) {
  FrontCamera camera(levelCamera(), straightRoad());
  const traffic::Vehicle ego = vehicleAt("ego", 0.0, 0.0);
  const double half_turn = 3.14159265358979323846;
  const auto image = camera.render(snapshotOf({ego, vehicleAt("other", 12.75, 0, half_turn)}), ego);
  const Pixel headlight = pixelAt(image, 85, 53);
  EXPECT_EQ(headlight, (Pixel{255, 250, 214}));
}

TEST(FrontCamera, DoesNotSeeItself) {
  FrontCamera camera(levelCamera(), straightRoad());
  const traffic::Vehicle ego = vehicleAt("ego", 0.0, 0.0);
  traffic::Vehicle ahead = ego;
  ahead.state.position.x() = 12.0;
  // A copy of another place is still told from the others by its id.
  EXPECT_EQ(camera.render(snapshotOf({ahead}), ego).rgb, camera.render(snapshotOf({}), ego).rgb);
  ahead.id = "other";
  EXPECT_NE(camera.render(snapshotOf({ahead}), ego).rgb, camera.render(snapshotOf({}), ego).rgb);
}

TEST(FrontCamera, SameInputSameBytes) {
  FrontCamera camera(CameraOptions(), signaledLane(30.0));
  FrontCamera second(CameraOptions(), signaledLane(30.0));
  const traffic::Vehicle ego = vehicleAt("ego", 0.0, 0.0, 0.03);
  traffic::TrafficSnapshot snapshot = snapshotOf({ego, vehicleAt("a", 15, 1.3, 0.4)});
  snapshot.tick = 17;
  const auto first = camera.render(snapshot, ego);
  EXPECT_EQ(first.width, 160);
  EXPECT_EQ(first.height, 96);
  EXPECT_EQ(first.tick, 17u);
  EXPECT_EQ(first.rgb.size(), 160u * 96u * 3u);
  camera.render(snapshot, vehicleAt("elsewhere", 25, 0, 2.0));
  EXPECT_EQ(camera.render(snapshot, ego).rgb, first.rgb);
  EXPECT_EQ(second.render(snapshot, ego).rgb, first.rgb);
}

}  // namespace
}  // namespace cdiff::rendering
