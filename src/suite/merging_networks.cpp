// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "suite/merging_networks.h"

#include <cmath>

#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/geometry/shapes.h"
#include "suite/network_generator.h"

namespace cdiff::suite {
namespace {

constexpr double kMedian = 1.0;    ///< half of it [m]
constexpr double kRampEnd = 6.0;   ///< of a ramp before the added lane [m]
constexpr double kBefore = 130.0;  ///< main road before the first ramp [m]
constexpr double kAfter = 130.0;   ///< and after the last [m]

/// One direction of the main road with its on-ramp.
class Carriageway {
 public:
  /// `middle`: the main road's middle in driving direction, the added lane from `begin` to `end` of
  /// it.
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
    const double angle = draws.uniform(20.0, 45.0) * core::kDegree;
    ramp.straight(8.0).arc(draws.uniform(40.0, 90.0), angle);
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
  const double side = draws.sign();
  const double angle = side * draws.uniform(5.0, 18.0) * core::kDegree;
  middle.arc(draws.uniform(150.0, 400.0), angle);
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

namespace {

constexpr double kEntryRadius = 12.0;                 ///< [m]
constexpr double kEntryAngle = 32.0 * core::kDegree;  ///< turned away before the ring
constexpr double kTrim = 22.0 * core::kDegree;        ///< of the ring, on both sides of an arm
constexpr double kEntryGap = 3.3;  ///< from an entry's end to the ring's middle [m]
constexpr double kLeastSpacing = 62.0 * core::kDegree;  ///< between arms

/// A roundabout of which everything is drawn; ring nodes stand where the arms' middles meet it.
class Roundabout {
 public:
  Roundabout(const NetworkSpec& spec, Draws& draws)
      : spec_(spec),
        radius_(spec.lanes > 1 ? draws.uniform(26.0, 34.0)
                               : draws.uniform(spec.arms > 4 ? 24.0 : 18.0, 30.0)),
        ring_speed_(radius_ > 24.0 ? 8.33 : 6.94) {
    drawAngles(draws);
  }

  RoadPlan plan(Draws& draws) {
    plan_.name = spec_.name;
    plan_.text = "Roundabout with " + std::to_string(spec_.lanes) + " lane(s), its roads drawn";
    const ArmShape shape(spec_.elevation, draws);
    for (int i = 0; i < spec_.arms; ++i) {
      const double angle = angles_[static_cast<std::size_t>(i)];
      const Eigen::Vector2d place = radius_ * geometry::direction(angle);
      plan_.nodes.push_back({ring(i), {place.x(), place.y(), 0.0}, "priority"});
      const double speed = drawSmallSpeed(draws);
      const Eigen::Vector2d begin = (radius_ + straightFrom()) * geometry::direction(angle);
      addRoad(i, shape.draw(begin, angle, speed, draws), speed);
    }
    for (int i = 0; i < spec_.arms; ++i) addRing(i);
    for (int i = 0; i < spec_.arms; ++i) connect(i);
    addPaths();
    PlanRoundabout whole;
    for (int i = 0; i < spec_.arms; ++i) {
      whole.nodes.push_back(ring(i));
      whole.edges.push_back(ringEdge(i));
    }
    plan_.roundabouts.push_back(whole);
    return plan_;
  }

 private:
  std::string ring(int i) const { return "ring" + std::to_string(i % spec_.arms); }
  /// From ring node i to the next, counter-clockwise.
  std::string ringEdge(int i) const { return "ring_edge" + std::to_string(i % spec_.arms); }
  static std::string arm(int i) { return "arm" + std::to_string(i); }
  double halfRoad() const { return 0.5 * spec_.lanes * kLaneWidth; }
  /// Where, outside the ring's middle, entries begin to turn away [m].
  double straightFrom() const {
    return kEntryGap + halfRoad() - 0.5 * kLaneWidth + kEntryRadius * std::sin(kEntryAngle);
  }

  void drawAngles(Draws& draws) {
    const double spare = 2.0 * core::kPi - spec_.arms * kLeastSpacing;
    double sum = 0.0;
    std::vector<double> shares;
    for (int i = 0; i < spec_.arms; ++i) sum += shares.emplace_back(draws.uniform(0.3, 1.0));
    double angle = draws.uniform(0.0, 2.0 * core::kPi);
    for (const double share : shares) {
      angles_.push_back(angle);
      angle += kLeastSpacing + spare * share / sum;
    }
    angles_.push_back(angles_.front() + 2.0 * core::kPi);
  }

  /// Entry and exit leave the road's middle line to their own sides.
  void addRoad(int i, const Line& middle, double speed) {
    const double heading = angles_[static_cast<std::size_t>(i)] + core::kPi;
    plan_.nodes.push_back({arm(i), middle.back(), ""});
    Line entry = beside(reversed(middle), -halfRoad());
    Line exit = reversed(beside(middle, -halfRoad()));
    extend(entry, heading, -kEntryAngle);
    extend(exit, heading, kEntryAngle);
    plan_.edges.push_back({arm(i) + "_in", arm(i), ring(i), spec_.lanes, speed, 3, entry, true});
    plan_.edges.push_back(
        {arm(i) + "_out", ring(i), arm(i), spec_.lanes, speed, 3, reversed(exit), true});
  }

  static void extend(Line& line, double heading, double angle) {
    const RoadLine curve = RoadLine(line.back().head<2>(), heading).arc(kEntryRadius, angle);
    line.insert(line.end(), curve.points().begin() + 1, curve.points().end());
  }

  void addRing(int i) {
    const double begin = angles_[static_cast<std::size_t>(i)] + kTrim;
    const double end = angles_[static_cast<std::size_t>(i) + 1] - kTrim;
    const Line arc = RoadLine(radius_ * geometry::direction(begin), begin + 0.5 * core::kPi)
                         .arc(radius_, end - begin)
                         .points();
    plan_.edges.push_back(
        {ringEdge(i), ring(i), ring(i + 1), spec_.lanes, ring_speed_, 9, arc, true});
  }

  /// The outer of two lanes leaves at the next exit, so that no exit crosses another lane.
  void connect(int i) {
    const std::string before = ringEdge(i + spec_.arms - 1);
    const int inner = spec_.lanes - 1;
    plan_.connections.push_back({before, ringEdge(i), inner, inner});
    for (int lane = 0; lane < spec_.lanes; ++lane) {
      plan_.connections.push_back({before, arm(i) + "_out", lane, lane});
      plan_.connections.push_back({arm(i) + "_in", ringEdge(i), lane, lane, true});
    }
  }

  void addPaths() {
    for (int from = 0; from < spec_.arms; ++from) {
      PlannedPath path{{arm(from) + "_in"}, "roundabout"};
      for (int passed = 0; passed + 1 < spec_.arms; ++passed) {
        path.edges.push_back(ringEdge(from + passed));
        PlannedPath whole = path;
        whole.edges.push_back(arm((from + passed + 1) % spec_.arms) + "_out");
        plan_.paths.push_back(whole);
      }
    }
  }

  const NetworkSpec& spec_;
  double radius_;
  double ring_speed_;
  std::vector<double> angles_;  ///< of the arms, the first again a turn later
  RoadPlan plan_;
};

}  // namespace

RoadPlan drawRoundabout(const NetworkSpec& spec, Draws& draws) {
  return Roundabout(spec, draws).plan(draws);
}

}  // namespace cdiff::suite
