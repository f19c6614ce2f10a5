// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <filesystem>
#include <optional>

#include "benchmark.h"
#include "core/file.h"
#include "e2e_cdiff/core/random.h"
#include "e2e_cdiff/map/drivable_area.h"
#include "map/import/network_import.h"
#include "map/route_source.h"

namespace cdiff::benchmark {
namespace {

/// Points up to 10 m beside lane centers of the network, as guidance asks for them.
std::vector<Eigen::Vector3d> pointsNearRoads(const map::RoadNetwork& network, std::size_t count) {
  const core::RandomStream random(1, "benchmark");
  std::vector<Eigen::Vector3d> points;
  for (std::uint32_t i = 0; points.size() < count; ++i) {
    const map::Lane& lane = network.lanes()[random.index({0, i, 0}, 0, network.lanes().size())];
    Eigen::Vector3d point =
        lane.centerline.pointAt(random.uniform({0, i, 0}, 1, 0.0, lane.centerline.length()));
    point.x() += random.uniform({0, i, 0}, 2, -10.0, 10.0);
    point.y() += random.uniform({0, i, 0}, 3, -10.0, 10.0);
    points.push_back(point);
  }
  return points;
}

double nanosecondsPerQuery(const map::DrivableArea& area,
                           const std::vector<Eigen::Vector3d>& points) {
  std::vector<double> rounds;
  double sum = 0.0;
  for (int round = 0; round < 5; ++round) {
    const double seconds = secondsOf([&] {
      for (const Eigen::Vector3d& point : points)
        sum += area.signedDistanceWithGradient(point.head<2>(), point.z()).distance;
    });
    rounds.push_back(1e9 * seconds / static_cast<double>(points.size()));
  }
  return sum == 0.0 ? 0.0 : median(rounds);
}

}  // namespace

void benchmarkMap(Figures& figures) {
  const std::filesystem::path data = dataFolder();
  for (const std::string town : {"Town01", "Town04", "Town05"}) {
    const std::string file = (data / "carla_towns" / (town + ".net.xml")).string();
    map::ImportedNetwork imported = map::importNetwork(file);
    figures.push_back({town + "_import_cached",
                       1e3 * secondsOf([&] { imported = map::importNetwork(file); }), "ms", ""});
    std::optional<map::RoadNetwork> network;
    figures.push_back(
        {town + "_parse",
         1e3 * secondsOf([&] { network.emplace(map::RoadNetwork::fromText(imported.text, town)); }),
         "ms", ""});
    const std::vector<Eigen::Vector3d> points = pointsNearRoads(*network, 100000);
    std::optional<map::DrivableArea> area;
    // A level is made when it is first asked for; a thousand points come to all of them.
    const auto make = [&](std::size_t asked) {
      return 1e3 * secondsOf([&] {
               area.emplace(*network);
               for (std::size_t i = 0; i < asked; ++i)
                 area->contains(points[i].head<2>(), points[i].z());
             });
    };
    std::filesystem::remove_all(core::cacheFolder() / "borders");
    figures.push_back({town + "_drivable_area_one_level", make(1), "ms", ""});
    std::filesystem::remove_all(core::cacheFolder() / "borders");
    figures.push_back({town + "_drivable_area", make(1000), "ms", ""});
    figures.push_back({town + "_drivable_area_kept", make(1000), "ms", ""});
    figures.push_back(
        {town + "_signed_distance", nanosecondsPerQuery(*area, points), "ns/query", "<=1000"});
  }
}

}  // namespace cdiff::benchmark
