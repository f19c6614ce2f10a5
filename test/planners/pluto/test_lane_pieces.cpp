// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cmath>

#include "e2e_cdiff/core/angle.h"
#include "planners/pluto/lane_pieces.h"
#include "planners/pluto/tracks.h"
#include "support/network_text.h"

namespace cdiff::planners {
namespace {

using Numbers = std::vector<std::uint32_t>;

LanePieces piecesOf(const std::string& shape) {
  return LanePieces(test::NetworkText().edge("road", {shape}).network());
}

void expectPoint(const LanePiece& piece, std::size_t i, const std::array<double, 10>& values) {
  for (std::size_t c = 0; c < values.size(); ++c)
    EXPECT_NEAR(piece.points[i * values.size() + c], values[c], 1e-5) << i << " " << c;
}

// 60 m are two pieces of 30 m, 30 / 19 m from point to point; the last has no next. The lane is 4 m
// wide.
TEST(LanePieces, AreEquallyLongAndAtMostFiftyMeters) {
  const LanePieces pieces = piecesOf("0,0 60,0");
  ASSERT_EQ(pieces.all().size(), 2U);
  for (std::size_t part = 0; part < 2; ++part) {
    const LanePiece& piece = pieces.all()[part];
    EXPECT_NEAR(piece.pose.position.x(), 15.0 + 30.0 * part, 1e-9);
    EXPECT_NEAR(piece.reach, 15.0, 1e-9);
    EXPECT_EQ(piece.lane, 0);
    for (std::size_t i = 0; i < 20; ++i) {
      const double step = i == 19 ? 0.0 : 30.0 / 19.0;
      expectPoint(piece, i, {-1.5 + 3.0 * i / 19.0, 0, step, 0, 1, 0, 0, 2, 0, -2});
      EXPECT_NEAR(piece.centers[i].x(), 30.0 * part + 30.0 * i / 19.0, 1e-9);
    }
  }
  EXPECT_EQ(piecesOf("0,0 49.9,0").all().size(), 1U);
  EXPECT_EQ(piecesOf("0,0 50.1,0").all().size(), 2U);
  EXPECT_EQ(piecesOf("0,0 1.1,0").all().size(), 1U);
  EXPECT_EQ(piecesOf("0,0 0.9,0").all().size(), 0U);
}

// 12 m along x and 8 m along y: the middle is 10 m on, 2 m before the corner; 20 / 19 m from point
// to point. Behind the corner the lane looks along y and its left border lies at smaller x.
TEST(LanePieces, AreGivenInTheFrameOfTheirMiddle) {
  const LanePieces pieces = piecesOf("100,50 112,50 112,58");
  ASSERT_EQ(pieces.all().size(), 1U);
  const LanePiece& piece = pieces.all()[0];
  EXPECT_NEAR((piece.pose.position - Eigen::Vector2d(110.0, 50.0)).norm(), 0.0, 1e-9);
  EXPECT_NEAR(piece.reach, 10.0, 1e-9);
  const auto at = [](double s) {
    return s < 12.0 ? Eigen::Vector2d(s - 10.0, 0.0) : Eigen::Vector2d(2.0, s - 12.0);
  };
  for (std::size_t i = 0; i < 20; ++i) {
    const double s = 20.0 * i / 19.0;
    const Eigen::Vector2d place = at(s), step = at(std::min(s + 20.0 / 19.0, 20.0)) - place;
    if (s < 12.0)
      expectPoint(piece, i, {place.x() / 10, 0, step.x(), step.y(), 1, 0, 0, 2, 0, -2});
    else
      expectPoint(piece, i, {0.2, place.y() / 10, step.x(), step.y(), 0, 1, -2, 0, 2, 0});
  }
}

TEST(LanePieces, KnowElevationAndLight) {
  const LanePieces pieces(test::NetworkText()
                              .edge("a", {"0,0,0 60,0,6"})
                              .edge("b", {"60,0,6 80,0,6"})
                              .edge("path", {"0,9 60,9"}, "a", "b", {4.0, 10.0, "pedestrian"})
                              .connection("a_0", "b_0", "", 's', "tl=\"light\" linkIndex=\"3\"")
                              .network());
  ASSERT_EQ(pieces.all().size(), 3U) << "none of the path";
  EXPECT_NEAR(pieces.all()[0].elevation, 1.5, 1e-6);
  EXPECT_NEAR(pieces.all()[1].elevation, 4.5, 1e-6);
  EXPECT_EQ(pieces.all()[1].signal, "");
  EXPECT_EQ(pieces.all()[1].link, -1);
  EXPECT_EQ(pieces.all()[2].signal, "light");
  EXPECT_EQ(pieces.all()[2].link, 3);
}

// Points of lanes at y = 0, 10 and 20 m, two pieces each; (0, 4) is 4, 6 and 16 m from the first
// points of the first pieces.
TEST(LanePieces, NearAPlaceTheNearestComeFirst) {
  const LanePieces pieces(
      test::NetworkText().edge("road", {"0,0 60,0", "0,10 60,10", "0,20 60,20"}).network());
  EXPECT_EQ(pieces.near({0.0, 4.0}, 0.0, 15.9, 9), (Numbers{0, 2}));
  EXPECT_EQ(pieces.near({0.0, 4.0}, 0.0, 16.1, 9), (Numbers{0, 2, 4}));
  EXPECT_EQ(pieces.near({0.0, 7.0}, 0.0, 16.1, 9), (Numbers{2, 0, 4}));
  EXPECT_EQ(pieces.near({0.0, 5.0}, 0.0, 15.1, 2), (Numbers{0, 2})) << "as near: by number";
  EXPECT_EQ(pieces.near({0.0, 7.0}, 0.0, 16.1, 1), Numbers{2});
  EXPECT_EQ(pieces.near({-20.0, 0.0}, 0.0, 20.1, 9), Numbers{0}) << "ahead of its beginning";
  EXPECT_TRUE(pieces.near({-20.0, 0.0}, 0.0, 19.9, 9).empty());
  EXPECT_TRUE(pieces.near({0.0, 4.0}, 5.0, 16.1, 9).empty()) << "on another level";
}

traffic::TrafficSnapshot at(double time, const std::vector<std::string>& ids) {
  traffic::TrafficSnapshot snapshot;
  snapshot.time = time;
  for (const std::string& id : ids) {
    snapshot.vehicles.emplace_back();
    snapshot.vehicles.back().id = id;
  }
  return snapshot;
}

// Half a period early or late is no gap.
TEST(RecentTracks, FollowEachOtherWithinHalfAPeriod) {
  RecentTracks tracks(0.1);
  const std::pair<double, std::size_t> decisions[] = {{0.0, 1},  {0.1, 2},  {0.24, 3}, {0.30, 4},
                                                      {0.46, 1}, {0.50, 1}, {0.60, 2}, {0.2, 1}};
  for (const auto& [time, known] : decisions) {
    tracks.add(at(time, {"a"}));
    EXPECT_EQ(tracks.frames().size(), known) << time;
  }
}

TEST(TrackFrame, FindsVehiclesByTheirNumber) {
  VehicleTable table;
  frameOf(at(0.0, {"a", "b", "c"}), table);
  traffic::TrafficSnapshot snapshot = at(0.1, {"c", "a"});
  snapshot.vehicles[0].acceleration = 1.5;
  snapshot.vehicles[1].applied_action = {0.0, 0.25, 0.5};
  const TrackFrame frame = frameOf(snapshot, table);
  ASSERT_NE(frame.find(2), nullptr);
  EXPECT_EQ(frame.find(2)->acceleration, 1.5F);
  EXPECT_EQ(frame.find(1), nullptr);
  EXPECT_EQ(frame.find(3), nullptr);
  ASSERT_NE(frame.find(0), nullptr);
  EXPECT_EQ(frame.find(0)->steer, 0.25F);
  EXPECT_EQ(frame.find(0)->brake, 0.5F);
  EXPECT_EQ(table.id(2), "c");
}

}  // namespace
}  // namespace cdiff::planners
