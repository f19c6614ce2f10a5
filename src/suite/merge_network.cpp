// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <cmath>

#include "e2e_cdiff/core/angle.h"
#include "suite/network_kinds.h"

namespace cdiff::suite {
namespace {

constexpr double kMedian = 1.0;    ///< half of it [m]
constexpr double kRampEnd = 6.0;   ///< of a ramp before the added lane [m]
constexpr double kBefore = 130.0;  ///< main road before the first ramp [m]
constexpr double kAfter = 130.0;   ///< and after the last [m]

/// One direction of the main road with its on-ramp.
class Carriageway {
 public:
  /// `middle`: the main road's middle in driving direction, the added lane from `begin` to
  /// `end` of it.
  Carriageway(std::string name, const Line& middle, double begin, double end, int lanes)
      : name_(std::move(name)),
        left_(beside(middle, -kMedian)),
        begin_(begin),
        end_(end),
        lanes_(lanes) {}

  void add(double speed, double elevation, RoadPlan& plan, Draws& draws) const {
    const double length = lengthOf(left_);
    plan.nodes.push_back({name_ + "_on", part(left_, begin_, end_).front(), "priority"});
    plan.nodes.push_back({name_ + "_end", part(left_, begin_, end_).back(), "priority"});
    const auto edge = [&](const char* suffix, const std::string& from, const std::string& to,
                          int lanes, double from_arc, double to_arc) {
      plan.edges.push_back(
          {name_ + suffix, from, to, lanes, speed, 9, part(left_, from_arc, to_arc), false});
    };
    edge("_before", name_ + "_from", name_ + "_on", lanes_, 0.0, begin_);
    edge("_merge", name_ + "_on", name_ + "_end", lanes_ + 1, begin_, end_);
    edge("_after", name_ + "_end", name_ + "_to", lanes_, end_, length);
    plan.nodes.push_back({name_ + "_from", left_.front(), ""});
    plan.nodes.push_back({name_ + "_to", left_.back(), ""});
    addRamp(elevation, plan, draws);
    connect(plan);
    plan.paths.push_back({{name_ + "_ramp", name_ + "_merge", name_ + "_after"}, "merge"});
  }

 private:
  /// Laid backwards from the added lane, then turned round.
  void addRamp(double elevation, RoadPlan& plan, Draws& draws) const {
    const Line beginning = part(left_, begin_ - kRampEnd, begin_);
    const Eigen::Vector2d along = (beginning.back() - beginning.front()).head<2>();
    const double heading = std::atan2(along.y(), along.x());
    const Line start = beside(beginning, -(lanes_ + 0.5) * kLaneWidth);
    RoadLine ramp(start.front().head<2>(), heading + core::kPi);
    ramp.straight(8.0).arc(draws.uniform(40.0, 90.0), draws.uniform(20.0, 45.0) * core::kDegree);
    ramp.straight(draws.uniform(60.0, 90.0));
    const Line line = reversed(climbing(ramp.points(), 10.0, elevation));
    const double speed = draws.pick(std::vector<double>{11.11, 13.89});
    plan.nodes.push_back({name_ + "_ramp_start", line.front(), ""});
    plan.edges.push_back(
        {name_ + "_ramp", name_ + "_ramp_start", name_ + "_on", 1, speed, 5, line, true});
  }

  /// The added lane ends in lane 0 of what follows.
  void connect(RoadPlan& plan) const {
    plan.connections.push_back({name_ + "_ramp", name_ + "_merge", 0, 0});
    plan.connections.push_back({name_ + "_merge", name_ + "_after", 0, 0});
    for (int lane = 0; lane < lanes_; ++lane) {
      plan.connections.push_back({name_ + "_before", name_ + "_merge", lane, lane + 1});
      plan.connections.push_back({name_ + "_merge", name_ + "_after", lane + 1, lane});
    }
  }

  std::string name_;
  Line left_;  ///< left border of its lanes
  double begin_;
  double end_;
  int lanes_;
};

}  // namespace

RoadPlan drawMerge(const NetworkSpec& spec, Draws& draws) {
  RoadPlan plan;
  plan.name = spec.name;
  plan.text = "Road with an on-ramp in each direction, drawn";
  const double added = draws.uniform(60.0, 110.0);
  RoadLine middle({0.0, 0.0}, draws.uniform(0.0, 2.0 * core::kPi));
  middle.straight(kBefore + added + 10.0);
  middle.arc(draws.uniform(150.0, 400.0), draws.sign() * draws.uniform(5.0, 18.0) * core::kDegree);
  middle.straight(kAfter - 10.0);
  const double length = lengthOf(middle.points());
  const double speed = drawLargeSpeed(draws);
  const double height = spec.elevation ? draws.sign() * draws.uniform(2.0, 5.0) : 0.0;
  const Line back = reversed(middle.points());
  Carriageway("forth", middle.points(), kBefore, kBefore + added, spec.lanes)
      .add(speed, height, plan, draws);
  Carriageway("back", back, length - kBefore - added, length - kBefore, spec.lanes)
      .add(speed, height, plan, draws);
  return plan;
}

}  // namespace cdiff::suite
