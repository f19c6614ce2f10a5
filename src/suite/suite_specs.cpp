// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "suite/suite_specs.h"

#include <array>

#include "suite/suite_generator.h"

namespace cdiff::suite {
namespace {

const std::array<const char*, 3> kControls = {"priority", "right_before_left", "traffic_light"};

std::string numbered(const std::string& name, int i) { return name + "_" + std::to_string(i + 1); }

/// Every combination of control, arms and lanes comes up; one network in four has elevation.
std::vector<NetworkSpec> trainingNetworks() {
  constexpr int kCrossings = 18;
  constexpr int kRoundabouts = 6;
  constexpr int kMerges = 8;
  constexpr int kDistricts = 6;
  std::vector<NetworkSpec> specs;
  for (int i = 0; i < kCrossings; ++i) {
    const std::string control = kControls[static_cast<std::size_t>(i % 3)];
    const int lanes = control == "right_before_left" ? 1 : 1 + (i / 3) % 3;
    specs.push_back({numbered("crossing", i), NetworkKind::kCrossing, 4 - (i / 3) % 2, lanes,
                     control, i % 4 == 3});
  }
  for (int i = 0; i < kRoundabouts; ++i)
    specs.push_back({numbered("roundabout", i), NetworkKind::kRoundabout, 3 + i % 3, 1 + i / 3, "",
                     i % 4 == 3});
  for (int i = 0; i < kMerges; ++i)
    specs.push_back({numbered("merge", i), NetworkKind::kMerge, 0, 1 + i % 3, "", i % 4 == 3});
  for (int i = 0; i < kDistricts; ++i)
    specs.push_back(
        {numbered("district", i), NetworkKind::kDistrict, 0, 1 + i % 2, "", i % 4 == 3});
  return specs;
}

std::vector<NetworkSpec> testNetworks() {
  const auto crossing = NetworkKind::kCrossing;
  return {{"test_crossing", crossing, 4, 1, "priority", false},
          {"test_t_junction", crossing, 3, 1, "priority", true},
          {"test_signals", crossing, 4, 2, "traffic_light", false},
          {"test_right_before_left", crossing, 4, 1, "right_before_left", false},
          {"test_district", NetworkKind::kDistrict, 0, 1, "", false},
          {"test_roundabout", NetworkKind::kRoundabout, 4, 1, "", false},
          {"test_merge", NetworkKind::kMerge, 0, 2, "", false}};
}

std::vector<RouteWish> testRoutes() {
  return {{"left", "medium", "test_crossing"},
          {"left", "medium", "test_t_junction"},
          {"left", "medium", "test_signals"},
          {"right", "high", "test_t_junction"},
          {"right", "medium", "test_right_before_left"},
          {"right", "low", "test_district"},
          {"straight", "medium", "test_crossing"},
          {"straight", "medium", "test_signals"},
          {"roundabout", "low", "test_roundabout"},
          {"merge", "high", "test_merge"}};
}

}  // namespace

const std::vector<std::string>& suiteKinds() {
  static const std::vector<std::string> kinds = {"test", "train"};
  return kinds;
}

std::int64_t defaultSeed(const std::string&) { return 1; }

std::map<std::string, int> routeCounts(const std::string& kind) {
  if (kind == "train")
    return {{"left", 66}, {"right", 66}, {"straight", 44}, {"roundabout", 22}, {"merge", 22}};
  std::map<std::string, int> counts;
  for (const RouteWish& wish : testRoutes()) ++counts[wish.manoeuvre];
  return counts;
}

std::vector<NetworkSpec> networkSpecs(const std::string& kind) {
  return kind == "train" ? trainingNetworks() : testNetworks();
}

std::vector<RouteWish> routeWishes(const std::string& kind) {
  if (kind != "train") return testRoutes();
  std::vector<RouteWish> wishes;
  for (const auto& [manoeuvre, count] : routeCounts(kind)) {
    for (int i = 0; i < count; ++i)
      wishes.push_back({manoeuvre, densities()[static_cast<std::size_t>(i) % 3], ""});
  }
  return wishes;
}

}  // namespace cdiff::suite
