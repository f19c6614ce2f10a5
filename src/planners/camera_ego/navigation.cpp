// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/camera_ego/navigation.h"

#include <algorithm>
#include <cmath>

#include "e2e_cdiff/core/angle.h"

namespace cdiff::planners {
namespace {

constexpr double kReached = 4.0;            // [m]
constexpr double kFarthest = 50.0;          // between nodes [m]
constexpr double kTurn = core::kPi / 6.0;   // crossings that turn less go straight on
constexpr double kLaneChangeLength = 10.0;  // [m]

constexpr const char* kNames[] = {"left",   "right",       "straight",
                                  "follow", "change_left", "change_right"};

RoadCommand turnOf(const map::Route& route, double begin, double end) {
  constexpr double kBeside = 2.0;  // [m]
  const double turn = core::wrapAngle(route.path().headingAt(end + kBeside) -
                                      route.path().headingAt(begin - kBeside));
  if (turn > kTurn) return RoadCommand::kLeft;
  return turn < -kTurn ? RoadCommand::kRight : RoadCommand::kStraight;
}

RoadCommand changeOf(const map::RoadNetwork& network, const map::Route& route, double arc_length) {
  const map::LaneIndex before = route.laneAt(std::max(0.0, arc_length - 2.0));
  const map::LaneIndex after = route.laneAt(arc_length + 2.0);
  const bool left = before != map::kNoLane && after != map::kNoLane &&
                    network.lane(after).index > network.lane(before).index;
  return left ? RoadCommand::kChangeLeft : RoadCommand::kChangeRight;
}

}  // namespace

const char* toText(RoadCommand command) { return kNames[static_cast<std::size_t>(command)]; }

Navigation::Navigation(const map::RoadNetwork& network, const map::Route& route) {
  const auto add = [&](double arc_length, RoadCommand command) {
    const double place = std::min(arc_length, route.length());
    nodes_.push_back({place, route.path().positionAt(place), command});
  };
  for (const auto& [begin, end] : route.junctionStretches()) {
    const RoadCommand turn = turnOf(route, begin, end);
    add(begin, turn);
    add(end, turn);
  }
  for (const double place : route.laneChanges()) {
    const RoadCommand change = changeOf(network, route, place);
    add(place, change);
    add(place + kLaneChangeLength, change);
  }
  add(route.length(), RoadCommand::kFollow);
  const auto earlier = [](const NavigationNode& left, const NavigationNode& right) {
    return left.arc_length < right.arc_length;
  };
  std::stable_sort(nodes_.begin(), nodes_.end(), earlier);
  double last = 0.0;
  const std::size_t count = nodes_.size();
  for (std::size_t i = 0; i < count; ++i) {
    const double next = nodes_[i].arc_length;
    while (next - last > kFarthest) add(last += kFarthest, RoadCommand::kFollow);
    last = next;
  }
  std::stable_sort(nodes_.begin(), nodes_.end(), earlier);
}

const NavigationNode& Navigation::next(double arc_length) const {
  const auto found = std::upper_bound(
      nodes_.begin(), nodes_.end(), arc_length + kReached,
      [](double wanted, const NavigationNode& node) { return wanted < node.arc_length; });
  return found == nodes_.end() ? nodes_.back() : *found;
}

const NavigationNode& NavigationFollower::next(const map::RoadNetwork& network,
                                               const map::Route& route,
                                               const Eigen::Vector2d& position) {
  follower_.update(route, position);
  if (!navigation_ || route_length_ != route.length()) {
    navigation_.emplace(network, route);
    route_length_ = route.length();
  }
  return navigation_->next(follower_.arcLength());
}

}  // namespace cdiff::planners
