// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "rendering/camera_worlds.h"

namespace cdiff::rendering {
namespace {

/// Rows of two images that differ anywhere in columns [begin, end).
std::vector<int> differingRows(const traffic::CameraImage& first,
                               const traffic::CameraImage& second, int begin, int end) {
  std::vector<int> rows;
  for (int row = 0; row < first.height; ++row) {
    bool same = true;
    for (int column = begin; column < end; ++column) {
      same = same && pixelAt(first, column, row) == pixelAt(second, column, row);
    }
    if (!same) rows.push_back(row);
  }
  return rows;
}

/// Two lanes eastwards, two westwards beside them, a bend away, and a bridge across; with y
/// mirrored when `sign` is -1 (the rightmost lane keeps index 0).
map::RoadNetwork mirrorableNetwork(double sign) {
  const auto text = [&](double y) { return std::to_string(sign * y); };
  const auto pair = [&](const std::string& id, const std::string& right, const std::string& left) {
    const bool kept = sign > 0.0;
    return "<edge id=\"" + id + "\" from=\"a\" to=\"b\"><lane id=\"" + id +
           "_0\" index=\"0\" width=\"3.5\" speed=\"14\" shape=\"" + (kept ? right : left) +
           "\"/><lane id=\"" + id + "_1\" index=\"1\" width=\"3.5\" speed=\"14\" shape=\"" +
           (kept ? left : right) + "\"/></edge>";
  };
  return map::RoadNetwork::fromText(
      "<net>" +
          pair("east", "-40," + text(0) + " 45," + text(0),
               "-40," + text(3.5) + " 45," + text(3.5)) +
          pair("west", "45," + text(10.5) + " -40," + text(10.5),
               "45," + text(7) + " -40," + text(7)) +
          "<edge id=\"bend\" from=\"b\" to=\"e\"><lane id=\"bend_0\" index=\"0\" width=\"7\" "
          "speed=\"14\" "
          "shape=\"45," +
          text(1.75) + " 60," + text(4) + ",0.5 70," + text(12) +
          ",1\"/></edge>"
          "<edge id=\"bridge\" from=\"c\" to=\"d\"><lane id=\"bridge_0\" index=\"0\" width=\"4\" "
          "speed=\"14\" shape=\"30," +
          text(-60) + ",6 35," + text(60) + ",6.5\"/></edge></net>",
      "mirrorable");
}

std::vector<traffic::Vehicle> mirrorableVehicles(double sign) {
  std::vector<traffic::Vehicle> vehicles = {vehicleAt("ego", 0.3, sign * 0.2, sign * 0.07),
                                            vehicleAt("a", 12.3, sign * 3.1, sign * 0.21),
                                            vehicleAt("b", 18.7, sign * 7.3, sign * 3.0),
                                            vehicleAt("c", 2.0, sign * 3.4, sign * 0.01),
                                            vehicleAt("d", 31.2, sign * -8.0, sign * 1.6),
                                            vehicleAt("e", 25.1, sign * -1.0, sign * 0.9)};
  vehicles[2].dimensions = {12.0, 2.5, 3.2};
  vehicles[4].state.elevation = 6.2;
  return vehicles;
}

TEST(FrontCameraScenes, MirroredWorldGivesTheMirroredImage) {
  FrontCamera camera(CameraOptions(), mirrorableNetwork(1.0));
  FrontCamera mirrored_camera(CameraOptions(), mirrorableNetwork(-1.0));
  const auto vehicles = mirrorableVehicles(1.0);
  const auto mirrored_vehicles = mirrorableVehicles(-1.0);
  const auto image = camera.render(snapshotOf(vehicles), vehicles[0]);
  const auto mirrored = mirrored_camera.render(snapshotOf(mirrored_vehicles), mirrored_vehicles[0]);
  for (int row = 0; row < image.height; ++row) {
    for (int column = 0; column < image.width; ++column) {
      ASSERT_EQ(pixelAt(image, column, row), pixelAt(mirrored, image.width - 1 - column, row))
          << column << ", " << row;
    }
  }
}

TEST(FrontCameraScenes, NearerHidesFartherInAnyOrder) {
  FrontCamera camera(levelCamera(), straightRoad());
  const traffic::Vehicle ego = vehicleAt("ego", 0.0, 0.0);
  const traffic::Vehicle near = vehicleAt("near", 12.75, 0.0);
  const traffic::Vehicle far = vehicleAt("far", 22.75, 0.0);
  const auto only_near = camera.render(snapshotOf({ego, near}), ego);
  const auto only_far = camera.render(snapshotOf({ego, far}), ego);
  EXPECT_NE(only_far.rgb, camera.render(snapshotOf({ego}), ego).rgb);
  // The far one, twice as far, lies inside the near one's outline.
  EXPECT_EQ(camera.render(snapshotOf({ego, near, far}), ego).rgb, only_near.rgb);
  EXPECT_EQ(camera.render(snapshotOf({ego, far, near}), ego).rgb, only_near.rgb);
}

TEST(FrontCameraScenes, LongVehicleHidesOneWhoseCenterIsNearer) {
  FrontCamera camera(levelCamera(), straightRoad());
  const traffic::Vehicle ego = vehicleAt("ego", 0.0, 0.0);
  // A train of 30 m from x = 6 to 36, its right side at y = 2.25; its center is 20.8 m from the
  // eye.
  traffic::Vehicle train = vehicleAt("train", 21.0, 3.5);
  train.dimensions = {30.0, 2.5, 3.2};
  // The car's corners (16, 6.1) to (20.5, 7.9) are seen through y = 2.25 at x >= 0.5 + 15.5 * 2.25
  // / 6.1 = 6.2 (and 6.2 at the far left one); its center is 19.1 m away.
  const traffic::Vehicle car = vehicleAt("car", 18.25, 7.0);
  const auto only_train = camera.render(snapshotOf({ego, train}), ego);
  EXPECT_NE(camera.render(snapshotOf({ego, car}), ego).rgb,
            camera.render(snapshotOf({ego}), ego).rgb);
  EXPECT_EQ(camera.render(snapshotOf({ego, train, car}), ego).rgb, only_train.rgb);
  EXPECT_EQ(camera.render(snapshotOf({ego, car, train}), ego).rgb, only_train.rgb);
}

TEST(FrontCameraScenes, ClipsAVehicleBesideTheCamera) {
  FrontCamera camera(levelCamera(), straightRoad());
  const traffic::Vehicle ego = vehicleAt("ego", 0.0, 0.0);
  // From x = -1.75 to 2.75: depth -2.25 to 2.25; its right side, y = 1.1, is seen at depths
  // above 1.1 (half the field of view is 45 degrees), left of column 79.5 - 80 * 1.1 / 2.25 = 40.4
  // (and of 47.3 where the shadow reaches).
  const auto beside = camera.render(snapshotOf({ego, vehicleAt("other", 0.5, 2.0)}), ego);
  const auto empty = camera.render(snapshotOf({ego}), ego);
  EXPECT_FALSE(differingRows(beside, empty, 0, 10).empty());
  EXPECT_TRUE(differingRows(beside, empty, 48, 160).empty());
  // Wholly behind the camera.
  const auto behind = camera.render(snapshotOf({ego, vehicleAt("other", -5.0, 0.5)}), ego);
  EXPECT_EQ(behind.rgb, empty.rgb);
}

TEST(FrontCameraScenes, VehicleAroundTheCameraDoesNotHarm) {
  FrontCamera camera(levelCamera(), straightRoad());
  const traffic::Vehicle ego = vehicleAt("ego", 0.0, 0.0);
  traffic::Vehicle around = vehicleAt("other", 0.5, 0.0);
  around.dimensions = {1000.0, 1000.0, 500.0};
  EXPECT_EQ(camera.render(snapshotOf({ego, around}), ego).rgb.size(), 160u * 96u * 3u);
}

TEST(FrontCameraScenes, VehicleOnABridgeIsNotOnOurRoad) {
  FrontCamera camera(levelCamera(), straightRoad());
  const traffic::Vehicle ego = vehicleAt("ego", 0.0, 0.0);
  traffic::Vehicle above = vehicleAt("above", 12.75, 0.0);
  above.state.elevation = 6.0;
  const auto image = camera.render(snapshotOf({ego, above}), ego);
  const auto empty = camera.render(snapshotOf({ego}), ego);
  // At depth 10 its underside is 6 - 1.4 m above the eye: no lower than row 47.5 - 8 * 4.6 = 10.7;
  // at its far end, depth 14.5, row 47.5 - 80 / 14.5 * 4.6 = 22.1.
  const std::vector<int> rows = differingRows(image, empty, 0, 160);
  ASSERT_FALSE(rows.empty());
  EXPECT_LE(rows.back(), 23);
}

TEST(FrontCameraScenes, BridgeHidesTheRoadBelowIt) {
  const std::string text =
      "<net>" + straightEdge("low", 0.0, 0.0) + straightEdge("high", 0.0, 6.0) + "</net>";
  FrontCamera camera(levelCamera(), map::RoadNetwork::fromText(text, "two levels"));
  traffic::Vehicle ego = vehicleAt("ego", 0.0, 0.0);
  ego.state.elevation = 6.0;
  const traffic::Vehicle below = vehicleAt("below", 25.0, 0.0);
  const auto empty = camera.render(snapshotOf({ego}), ego);
  // The low road is seen at most 1.4 / 7.4 of its distance away on ours: behind it everywhere.
  EXPECT_EQ(camera.render(snapshotOf({ego, below}), ego).rgb, empty.rgb);
  traffic::Vehicle ahead = below;
  ahead.state.elevation = 6.0;
  EXPECT_NE(camera.render(snapshotOf({ego, ahead}), ego).rgb, empty.rgb);
}

TEST(FrontCameraScenes, HighRoadsHaveSlopesOrADecksSide) {
  const auto middle = [](double low_y, double eye_y, int row) {
    const std::string text =
        "<net>" + straightEdge("low", low_y, 0.0) + straightEdge("high", 0.0, 6.0) + "</net>";
    FrontCamera camera(levelCamera(), map::RoadNetwork::fromText(text, "two levels"));
    const traffic::Vehicle ego = vehicleAt("ego", 0.0, eye_y - 0.5, 0.5 * 3.14159265358979323846);
    return pixelAt(camera.render(snapshotOf({ego}), ego), 79, row);
  };
  // The low road is 28 m away: grass from (y, z) = (-2.2, 6) down to (-11.2, 0). Half-way, 22.8 m
  // ahead and 1.6 m above the eye: row 47.5 - 80 * 1.6 / 22.8 = 41.9.
  EXPECT_EQ(middle(-30.0, -29.5, 42), (Pixel{104, 136, 78}));
  // The low road is 8 m away: the deck's side, 5.1 to 6 m high and 17.3 m ahead, rows 26.2 to 30.4.
  EXPECT_EQ(middle(-10.0, -19.5, 28), (Pixel{166, 166, 160}));
}

TEST(FrontCameraScenes, MarkingsAreWhereTheLanesEnd) {
  FrontCamera camera(levelCamera(), mirrorableNetwork(1.0));
  traffic::Vehicle ego = vehicleAt("ego", 0.0, 0.0);
  const auto image = camera.render(snapshotOf({ego}), ego);
  // Row 75: depth 112 / 27.5 = 4.07 m, 19.6 columns per meter. The right edge's line is at y =
  // -1.63: column 111.5; the dashes at y = 1.75 (a dash starts at -40 + 45 = 5: bare here):
  // column 45.1; the yellow line of our side at y = 5.13 lies beyond the image, so row 57
  // (depth 11.8): column 44.7.
  const auto brightest = [&](int row, int begin, int end) {
    int best = begin;
    for (int column = begin; column < end; ++column) {
      if (pixelAt(image, column, row)[0] > pixelAt(image, best, row)[0]) best = column;
    }
    return best;
  };
  EXPECT_NEAR(brightest(75, 100, 125), 111.5, 1.0);
  const Pixel asphalt = pixelAt(image, 79, 75);
  EXPECT_EQ(pixelAt(image, 45, 75), asphalt);
  EXPECT_NEAR(brightest(57, 40, 50), 44.7, 1.0);
  const Pixel yellow = pixelAt(image, brightest(57, 40, 50), 57);
  EXPECT_GT(yellow[0], yellow[2] + 40);
}

}  // namespace
}  // namespace cdiff::rendering
