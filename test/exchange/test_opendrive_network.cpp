// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "core/file.h"
#include "e2e_cdiff/map/road_network.h"
#include "exchange/opendrive_network.h"
#include "support/temporary_folder.h"

namespace cdiff::exchange {
namespace {

TEST(OpenDriveNetworkTest, ShippedRoadsKeepTheirPlaces) {
  const OpenDriveNetwork network = openDriveOf(map::importNetwork("arterial_merge"));
  EXPECT_GT(network.roads.points, 1000U);
  EXPECT_EQ(network.roads.missing, 0U);
  EXPECT_LT(network.roads.p99, 0.3);
  EXPECT_LT(network.roads.largest, 1.0);
  EXPECT_GT(network.junctions.points, 10U);
}

TEST(OpenDriveNetworkTest, TheTextHoldsNoDateAndNoPath) {
  const map::ImportedNetwork import = map::importNetwork("roundabout");
  const OpenDriveNetwork network = openDriveOf(import);
  EXPECT_NE(network.text.find("<OpenDRIVE"), std::string::npos);
  EXPECT_EQ(network.text.find("generated on"), std::string::npos);
  EXPECT_EQ(network.text.find(" date="), std::string::npos);
  EXPECT_EQ(network.text, openDriveOf(import).text);
}

/// netconvert places the ends of this road beyond it, at negative x.
TEST(OpenDriveNetworkTest, OurImporterKeepsTheMapFrame) {
  const std::string road =
      (core::shareFolder() / "config/openscenario/straight_road.xodr").string();
  const OpenDriveNetwork network = openDriveOf(map::importNetwork(road));
  const test::TemporaryFolder folder;
  const std::string file = (folder.path() / "again.xodr").string();
  core::writeFileAtomically(file, network.text);
  const auto again = map::RoadNetwork::fromText(map::importNetwork(file).text, file);
  EXPECT_EQ(again.netOffset(), Eigen::Vector2d(0.0, 0.0));
  EXPECT_FALSE(again.lanesNear({0.5, -5.25}, 0.0, 0.01, 0.0).empty());
  EXPECT_EQ(network.roads.missing, 0U);
  EXPECT_LT(network.roads.largest, 0.01);
}

}  // namespace
}  // namespace cdiff::exchange
