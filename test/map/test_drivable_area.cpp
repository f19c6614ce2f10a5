// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <future>
#include <limits>

#include "core/file.h"
#include "core/text.h"
#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/core/random.h"
#include "e2e_cdiff/map/drivable_area.h"
#include "support/network_text.h"
#include "support/real_data.h"

namespace cdiff::map {
namespace {

using test::NetworkText;
using Point = Eigen::Vector2d;

constexpr double kGrid = 2e-3;  // [m] two roundings to the millimeter grid

/// Signed distance by the definition: nearest segment of all rings, inside by the even-odd rule.
double definition(const std::vector<std::vector<Point>>& rings, const Point& point) {
  double nearest = std::numeric_limits<double>::infinity();
  bool inside = false;
  for (const auto& ring : rings) {
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const Point& a = ring[i];
      const Point& b = ring[(i + 1) % ring.size()];
      const double share = std::clamp((b - a).dot(point - a) / (b - a).squaredNorm(), 0.0, 1.0);
      nearest = std::min(nearest, (a + share * (b - a) - point).norm());
      const bool straddles = (a.y() > point.y()) != (b.y() > point.y());
      if (!straddles) continue;
      const double crossing = a.x() + (point.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x());
      if (point.x() < crossing) inside = !inside;
    }
  }
  return inside ? nearest : -nearest;
}

/// Compares with the definition at `count` random points up to `reach` meters beside lanes' center
/// lines.
void expectDefinition(const RoadNetwork& network, std::uint32_t count, double reach) {
  const DrivableArea area(network);
  const core::RandomStream random(7, "points");
  std::uint32_t inside = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto lane = random.index({}, 4 * i, network.lanes().size());
    const geometry::Polyline& line = network.lanes()[lane].centerline;
    const Eigen::Vector3d on_line = line.pointAt(random.uniform({}, 4 * i + 1) * line.length());
    const Point offset(random.uniform({}, 4 * i + 2, -reach, reach),
                       random.uniform({}, 4 * i + 3, -reach, reach));
    const Point point = on_line.head<2>() + offset;
    const double expected = definition(area.border(on_line.z()), point);
    ASSERT_NEAR(area.signedDistance(point, on_line.z()), expected, 1e-6)
        << "at " << point.transpose() << ", elevation " << on_line.z();
    ASSERT_EQ(area.contains(point, on_line.z()), expected > 0.0);
    if (expected > 0.0) ++inside;
  }
  EXPECT_GT(inside, count / 20);
  EXPECT_LT(inside, count - count / 20);
}

/// Every point of a car lane's centerline lies at least 0.3 widths inside, whatever the union did
/// to the lanes.
void expectLanesInside(const RoadNetwork& network) {
  const DrivableArea area(network);
  for (const Lane& lane : network.lanes()) {
    if (!lane.allows_cars) continue;
    for (const Eigen::Vector3d& point : lane.centerline.resampled(1.0)) {
      ASSERT_GE(area.signedDistance(point.head<2>(), point.z()), 0.3 * lane.width)
          << lane.id << " at " << point.transpose();
    }
  }
}

RoadNetwork town(const std::string& name) {
  return RoadNetwork::fromText(core::readFile(test::realData("carla_towns/" + name), "network"),
                               name);
}

/// A road along x from 0 to 40 and from 50 to 90, a road from the south, and the junction between
/// them; all 4 m wide.
NetworkText tNetwork() {
  NetworkText text;
  text.edge("west", {"0,0 40,0"}, "a", "j").edge("east", {"50,0 90,0"}, "j", "b");
  text.edge("south", {"45,-40 45,-2"}, "c", "j");
  text.junction("j", "40,-2 40,2 50,2 50,-2").junction("b", "");
  return text;
}

/// Regular polygon of 32 corners and radius 20 around the origin, closed in the middle of a side.
std::string ringShape() {
  const auto corner = [](int i) {
    const double angle = core::kPi * i / 16.0;
    return Point(20.0 * std::cos(angle), 20.0 * std::sin(angle));
  };
  const auto write = [](const Point& point) {
    return core::formatNumber(point.x()) + "," + core::formatNumber(point.y()) + " ";
  };
  const Point middle = 0.5 * (corner(0) + corner(31));
  std::string shape = write(middle);
  for (int i = 0; i < 32; ++i) shape += write(corner(i));
  return shape + write(middle);
}

TEST(DrivableArea, StraightRoad) {
  const RoadNetwork network = NetworkText().edge("road", {"0,0 100,0"}).network();
  const DrivableArea area(network);
  EXPECT_EQ(area.levelCount(), 1u);
  // 4 m wide: the borders are y = +-2, x = 0 and x = 100.
  EXPECT_NEAR(area.signedDistance({50.0, 0.0}), 2.0, kGrid);
  EXPECT_NEAR(area.signedDistance({50.0, 1.5}), 0.5, kGrid);
  EXPECT_NEAR(area.signedDistance({50.0, -3.0}), -1.0, kGrid);
  EXPECT_NEAR(area.signedDistance({99.0, 0.0}), 1.0, kGrid);
  EXPECT_NEAR(area.signedDistance({103.0, 6.0}), -5.0, kGrid);      // corner (100, 2): 3 and 4 away
  EXPECT_NEAR(area.signedDistance({1100.0, 0.0}), -1000.0, kGrid);  // beyond the indexed ground
  EXPECT_TRUE(area.contains({50.0, 1.9}));
  EXPECT_FALSE(area.contains({50.0, 2.1}));
  EXPECT_NEAR(area.signedDistance(geometry::OrientedBox{{50.0, 0.5}, 0.0, 4.0, 2.0}), 0.5, kGrid);
  EXPECT_NEAR(area.signedDistance(geometry::OrientedBox{{98.0, -1.5}, 0.0, 4.0, 2.0}), -0.5, kGrid);
  const SignedDistance above = area.signedDistanceWithGradient({50.0, 3.0});
  EXPECT_NEAR(above.gradient.x(), 0.0, 1e-9);
  EXPECT_NEAR(above.gradient.y(), -1.0, 1e-9);
  const SignedDistance below = area.signedDistanceWithGradient({50.0, -1.0});
  EXPECT_NEAR(below.gradient.y(), 1.0, 1e-9);
}

TEST(DrivableArea, OnTheBorderTheGradientPointsInside) {
  const DrivableArea area(NetworkText().edge("road", {"0,0 100,0"}).network());
  const double border = area.border().front().front().y() > 0.0 ? 2.0 : -2.0;
  const SignedDistance on = area.signedDistanceWithGradient({50.0, border});
  EXPECT_NEAR(on.distance, 0.0, kGrid);
  EXPECT_NEAR(on.gradient.y(), -std::copysign(1.0, border), 1e-9);
}

TEST(DrivableArea, NoBorderBetweenLanesThatTouchOrAlmostTouch) {
  // Two lanes 4 m wide, side by side: y from -4 to 4.
  const DrivableArea touching(NetworkText().edge("road", {"0,-2 100,-2", "0,2 100,2"}).network());
  EXPECT_NEAR(touching.signedDistance({50.0, 0.0}), 4.0, kGrid);
  EXPECT_EQ(touching.border().size(), 1u);
  // A slit of 0.2 m: y from -4 to 4.2.
  const DrivableArea slit(NetworkText().edge("road", {"0,-2 100,-2", "0,2.2 100,2.2"}).network());
  EXPECT_NEAR(slit.signedDistance({50.0, 0.0}), 4.0, kGrid);
  EXPECT_EQ(slit.border().size(), 1u);
  // A green strip of 1 m stays: its middle is 0.5 m outside.
  const DrivableArea strip(NetworkText().edge("road", {"0,-2 100,-2", "0,3 100,3"}).network());
  EXPECT_NEAR(strip.signedDistance({50.0, 0.5}), -0.5, kGrid);
}

TEST(DrivableArea, LanesWithoutCarsDoNotCount) {
  test::LaneText footpath;
  footpath.allow = "pedestrian";
  NetworkText text;
  text.edge("road", {"0,0 100,0"}).edge("path", {"0,10 100,10"}, "a", "b", footpath);
  const DrivableArea area(text.network());
  EXPECT_NEAR(area.signedDistance({50.0, 10.0}), -8.0, kGrid);  // border of the road at y = 2
  EXPECT_THROW(DrivableArea(NetworkText().edge("path", {"0,0 9,0"}, "a", "b", footpath).network()),
               core::InputError);
}

TEST(DrivableArea, Junction) {
  const DrivableArea area(tNetwork().network());
  EXPECT_EQ(area.border().size(), 1u);
  // Nearest is the northern border y = 2, or the inner corner (43, -2) of western road and side
  // road.
  EXPECT_NEAR(area.signedDistance({45.0, 0.0}), 2.0, kGrid);
  const SignedDistance corner = area.signedDistanceWithGradient({44.5, -1.0});
  EXPECT_NEAR(corner.distance, std::hypot(1.5, 1.0), kGrid);
  EXPECT_NEAR(corner.gradient.x(), 1.5 / std::hypot(1.5, 1.0), 1e-3);
  EXPECT_NEAR(corner.gradient.y(), 1.0 / std::hypot(1.5, 1.0), 1e-3);
  EXPECT_NEAR(area.signedDistance({42.5, -4.0}), -0.5, kGrid);
  EXPECT_NEAR(area.signedDistance({40.0, 0.0}), 2.0, kGrid);  // where edge and junction touch
}

TEST(DrivableArea, IslandOfARoundabout) {
  const DrivableArea area(NetworkText().edge("ring", {ringShape()}).network());
  ASSERT_EQ(area.border().size(), 2u);
  // The island's sides lie half a width, 2 m, inside those of the centerline, whose apothem is 20
  // cos(pi / 32).
  EXPECT_NEAR(area.signedDistance({0.0, 0.0}), -(20.0 * std::cos(core::kPi / 32.0) - 2.0), kGrid);
  EXPECT_TRUE(area.contains({0.0, 20.0}));
  EXPECT_FALSE(area.contains({0.0, 23.0}));
}

TEST(DrivableArea, BridgeOverARoad) {
  NetworkText text;
  text.edge("low", {"0,0,0 100,0,0"}).edge("high", {"50,-50,8 50,50,8"});
  const DrivableArea area(text.network());
  // Heights 0 and 2 reach the road, 6 and 8 the bridge, 4 neither (3 m): two levels.
  EXPECT_EQ(area.levelCount(), 2u);
  EXPECT_NEAR(area.signedDistance({50.0, 10.0}, 0.0), -8.0,
              kGrid);  // beside the road, below the bridge
  EXPECT_NEAR(area.signedDistance({50.0, 10.0}, 8.0), 2.0, kGrid);  // on the bridge
  EXPECT_NEAR(area.signedDistance({60.0, 0.0}, 0.0), 2.0, kGrid);
  EXPECT_NEAR(area.signedDistance({60.0, 0.0}, 8.0), -8.0, kGrid);
  EXPECT_NEAR(area.signedDistance({50.0, 10.0}, 3.9), -8.0, kGrid);  // 2 is nearer than 6
  EXPECT_NEAR(area.signedDistance({50.0, 10.0}, 4.1), 2.0, kGrid);
  EXPECT_NEAR(area.signedDistance({50.0, 10.0}, 90.0), 2.0, kGrid);
}

TEST(DrivableArea, RampRunsThroughAllLevels) {
  const RoadNetwork network = NetworkText().edge("ramp", {"0,0,0 100,0,10"}).network();
  const DrivableArea area(network);
  EXPECT_GT(area.levelCount(), 3u);
  for (double x = 2.0; x <= 98.0; x += 0.5) {
    ASSERT_NEAR(area.signedDistance({x, 0.0}, 0.1 * x), 2.0, kGrid) << "at x = " << x;
  }
}

TEST(DrivableArea, GradientIsThatOfTheDistance) {
  const DrivableArea area(tNetwork().network());
  const core::RandomStream random(3, "gradient");
  constexpr double kStep = 1e-5;
  int compared = 0;
  for (std::uint32_t i = 0; i < 2000; ++i) {
    const Point point(random.uniform({}, 2 * i, -10.0, 100.0),
                      random.uniform({}, 2 * i + 1, -50.0, 12.0));
    const auto slope = [&](const Point& axis) {
      return (area.signedDistance(point + kStep * axis) -
              area.signedDistance(point - kStep * axis)) /
             (2.0 * kStep);
    };
    const Point numeric(slope(Point::UnitX()), slope(Point::UnitY()));
    if (std::abs(numeric.norm() - 1.0) > 1e-6) continue;  // two borders equally near: a kink
    ++compared;
    const Point gradient = area.signedDistanceWithGradient(point).gradient;
    ASSERT_NEAR((gradient - numeric).norm(), 0.0, 1e-5) << "at " << point.transpose();
  }
  EXPECT_GT(compared, 1900);
}

TEST(DrivableArea, EqualsTheDefinitionOnHandMadeNetworks) {
  expectDefinition(tNetwork().network(), 4000, 20.0);
  NetworkText ring = tNetwork();
  ring.edge("ring", {ringShape()}).edge("spike", {"0,0 60,5 0,10"});
  expectDefinition(ring.network(), 4000, 25.0);
}

TEST(DrivableArea, EqualsTheDefinitionAtAndAroundCorners) {
  const DrivableArea area(tNetwork().network());
  const auto rings = area.border();
  for (const Point& corner : rings.front()) {
    for (int i = 0; i < 360; i += 5) {
      const Point point = corner + 0.7 * geometry::direction(core::degreesToRadians(i + 0.5));
      ASSERT_NEAR(area.signedDistance(point), definition(rings, point), 1e-6)
          << "at " << point.transpose();
    }
  }
}

TEST(DrivableArea, AnswersAreTheSameWhoeverAsksFirst) {
  // 900 m of road: several squares, which are split when a query first comes to them.
  NetworkText text;
  text.edge("long", {"0,0 900,0"});
  const DrivableArea shared(text.network());
  std::vector<std::future<void>> askers;
  for (int i = 0; i < 4; ++i) {
    askers.push_back(std::async(std::launch::async, [&, i] {
      for (int j = 0; j < 450; ++j) shared.signedDistance({2.0 * ((j + 100 * i) % 450), 0.5});
    }));
  }
  for (std::future<void>& asker : askers) asker.get();
  const DrivableArea alone(text.network());
  for (int x = 898; x >= 0; --x) {
    const Point point(x, 0.5);
    ASSERT_EQ(shared.signedDistance(point), alone.signedDistance(point)) << "at x " << x;
  }
}

TEST(DrivableArea, EqualsTheDefinitionOnTown05) {
  CDIFF_SKIP_WITHOUT(test::realData("carla_towns/Town05.net.xml"));
  const RoadNetwork network = town("Town05.net.xml");
  expectDefinition(network, 4000, 15.0);
  expectLanesInside(network);
}

TEST(DrivableArea, EqualsTheDefinitionOnTown04) {
  CDIFF_SKIP_WITHOUT(test::realData("carla_towns/Town04.net.xml"));
  const RoadNetwork network = town("Town04.net.xml");
  expectDefinition(network, 4000, 15.0);
  expectLanesInside(network);
}

}  // namespace
}  // namespace cdiff::map
