// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "exchange/opendrive_network.h"

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

}  // namespace
}  // namespace cdiff::exchange
