// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/uniad_mini/motion_anchors.h"

#include <algorithm>

namespace cdiff::planners {
namespace {

constexpr double kNarrowest = 1.2;  // [m]
constexpr double kLongest = 6.5;    // [m]
constexpr std::size_t kModes = kMotionModes;

MotionAnchors straightAnchors() {
  constexpr double kSpeedStep = 3.0;  // [m/s]
  MotionAnchors anchors;
  for (std::size_t mode = 0; mode < anchors.size(); ++mode) {
    const double step = kSpeedStep * static_cast<double>(mode) * kEgoWaypointPeriod;
    for (std::size_t i = 0; i < anchors[mode].size(); ++i)
      anchors[mode][i] = {step * static_cast<double>(i + 1), 0.0};
  }
  return anchors;
}

std::size_t nearestMode(const MotionAnchors& anchors, const EgoWaypoints& way) {
  std::size_t best = 0;
  for (std::size_t mode = 1; mode < anchors.size(); ++mode) {
    if ((anchors[mode].back() - way.back()).squaredNorm() <
        (anchors[best].back() - way.back()).squaredNorm())
      best = mode;
  }
  return best;
}

/// Means of the clusters; a cluster without ways stays where it is.
MotionAnchors meansOf(const std::vector<EgoWaypoints>& ways, const MotionAnchors& anchors) {
  MotionAnchors sums = {};
  for (EgoWaypoints& sum : sums) sum.fill(Eigen::Vector2d::Zero());
  std::array<double, kModes> counts{};
  for (const EgoWaypoints& way : ways) {
    const std::size_t mode = nearestMode(anchors, way);
    counts[mode] += 1.0;
    for (std::size_t i = 0; i < way.size(); ++i) sums[mode][i] += way[i];
  }
  for (std::size_t mode = 0; mode < kModes; ++mode) {
    for (std::size_t i = 0; i < sums[mode].size(); ++i)
      sums[mode][i] =
          counts[mode] > 0.0 ? Eigen::Vector2d(sums[mode][i] / counts[mode]) : anchors[mode][i];
  }
  return sums;
}

bool endsNearer(const EgoWaypoints& left, const EgoWaypoints& right) {
  return left.back().squaredNorm() < right.back().squaredNorm();
}

MotionAnchors clustersOf(std::vector<EgoWaypoints> ways) {
  constexpr int kMostRounds = 50;
  std::stable_sort(ways.begin(), ways.end(), endsNearer);
  MotionAnchors anchors;
  for (std::size_t mode = 0; mode < kModes; ++mode)
    anchors[mode] = ways[(2 * mode + 1) * ways.size() / (2 * kModes)];
  for (int round = 0; round < kMostRounds; ++round) {
    const MotionAnchors means = meansOf(ways, anchors);
    if (means == anchors) break;
    anchors = means;
  }
  std::stable_sort(anchors.begin(), anchors.end(), endsNearer);
  return anchors;
}

}  // namespace

MotionGroup motionGroupOf(double length, double width) {
  if (width < kNarrowest) return MotionGroup::kNarrow;
  return length > kLongest ? MotionGroup::kLarge : MotionGroup::kCar;
}

std::array<MotionAnchors, kMotionGroups> clusterAnchors(const std::vector<TakenWay>& ways) {
  std::array<std::vector<EgoWaypoints>, kMotionGroups> by_group;
  for (const TakenWay& way : ways)
    by_group[static_cast<std::size_t>(way.group)].push_back(way.places);
  std::array<MotionAnchors, kMotionGroups> anchors;
  for (std::size_t group = 0; group < by_group.size(); ++group) {
    const bool enough = by_group[group].size() >= kModes;
    if (enough) {
      anchors[group] = clustersOf(by_group[group]);
    } else {
      anchors[group] = group > 0 ? anchors.front() : straightAnchors();
    }
  }
  return anchors;
}

inference::Tensor toTensor(const std::array<MotionAnchors, kMotionGroups>& anchors) {
  inference::Tensor tensor{{kMotionGroups * kMotionModes, 2 * kEgoWaypoints}, {}};
  for (const MotionAnchors& group : anchors) {
    for (const EgoWaypoints& way : group) {
      for (const Eigen::Vector2d& place : way) {
        tensor.values.push_back(static_cast<float>(place.x()));
        tensor.values.push_back(static_cast<float>(place.y()));
      }
    }
  }
  return tensor;
}

std::array<MotionAnchors, kMotionGroups> toAnchors(const inference::Tensor& tensor) {
  std::array<MotionAnchors, kMotionGroups> anchors;
  const float* value = tensor.values.data();
  for (MotionAnchors& group : anchors) {
    for (EgoWaypoints& way : group) {
      for (Eigen::Vector2d& place : way) {
        place = {static_cast<double>(value[0]), static_cast<double>(value[1])};
        value += 2;
      }
    }
  }
  return anchors;
}

}  // namespace cdiff::planners
