// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "suite/crossing_networks.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/geometry/shapes.h"
#include "suite/network_generator.h"

namespace cdiff::suite {
namespace {

/// Directions of the arms; the main road's two come first, a third stands to either side of it.
std::vector<double> armHeadings(int arms, Draws& draws) {
  constexpr double kMainBend = 14.0 * core::kDegree;
  constexpr double kSkew = 22.0 * core::kDegree;
  const double main = draws.uniform(0.0, 2.0 * core::kPi);
  std::vector<double> headings = {main, main + core::kPi + draws.uniform(-kMainBend, kMainBend)};
  const double side = draws.sign();
  headings.push_back(main + side * 0.5 * core::kPi + draws.uniform(-kSkew, kSkew));
  if (arms > 3) headings.push_back(main - side * 0.5 * core::kPi + draws.uniform(-kSkew, kSkew));
  return headings;
}

void addPaths(int arms, RoadPlan& plan) {
  for (int from = 0; from < arms; ++from) {
    for (int to = 0; to < arms; ++to) {
      if (from == to) continue;
      plan.paths.push_back(
          {{"arm" + std::to_string(from) + "_in", "arm" + std::to_string(to) + "_out"}, ""});
    }
  }
}

}  // namespace

RoadPlan drawCrossing(const NetworkSpec& spec, Draws& draws) {
  const bool equal = spec.control == "right_before_left";
  RoadPlan plan;
  plan.name = spec.name;
  plan.text = std::string(spec.arms == 3 ? "T junction" : "Crossing") + " (" + spec.control +
              "), its roads drawn";
  plan.nodes.push_back({"crossing", Eigen::Vector3d::Zero(), spec.control});
  const std::vector<double> headings = armHeadings(spec.arms, draws);
  const double main_speed = equal ? drawSmallSpeed(draws) : drawLargeSpeed(draws);
  const double side_speed = equal ? main_speed : std::min(main_speed, drawSmallSpeed(draws));
  const int side_lanes = draws.whole(1, std::min(2, spec.lanes));
  const ArmShape shape(spec.elevation, draws);
  for (int i = 0; i < spec.arms; ++i) {
    const bool main = i < 2;
    ArmPlan arm;
    arm.name = "arm" + std::to_string(i);
    arm.inner = "crossing";
    arm.lanes = main ? spec.lanes : side_lanes;
    arm.speed = main ? main_speed : side_speed;
    arm.line = shape.draw({0.0, 0.0}, headings[static_cast<std::size_t>(i)], arm.speed, draws);
    arm.priority = main && !equal ? 9 : 5;
    addArm(arm, plan);
  }
  addPaths(spec.arms, plan);
  return plan;
}

namespace {

/// Two rows of crossings with streets between and around them.
class District {
 public:
  District(const NetworkSpec& spec, Draws& draws)
      : spec_(spec), columns_(draws.whole(2, 3)), main_row_(draws.whole(0, 1)), draws_(draws) {}

  RoadPlan plan() {
    plan_.name = spec_.name;
    plan_.text = "District of " + std::to_string(2 * columns_) + " crossings, its streets drawn";
    for (int row = 0; row < 2; ++row) {
      for (int column = 0; column < columns_; ++column) addCrossing(row, column);
    }
    main_speed_ = drawLargeSpeed(draws_);
    for (int row = 0; row < 2; ++row) addStreetAlong(row);
    for (int column = 0; column < columns_; ++column) addStreetAcross(column);
    addPaths();
    return plan_;
  }

 private:
  struct Road {
    std::string from;
    std::string to;
  };
  static std::string crossing(int row, int column) {
    return "c" + std::to_string(row) + std::to_string(column);
  }

  void addCrossing(int row, int column) {
    constexpr double kSpacing = 110.0;  // [m]
    constexpr double kShift = 14.0;     // [m]
    const double shift_y = draws_.uniform(-kShift, kShift);
    const double shift_x = draws_.uniform(-kShift, kShift);
    const Eigen::Vector3d place(column * kSpacing + shift_x, row * kSpacing + shift_y, 0.0);
    const std::array<const char*, 3> types = {"priority", "traffic_light", "right_before_left"};
    const int type = row == main_row_ ? draws_.whole(0, 1) : draws_.whole(0, 2);
    plan_.nodes.push_back({crossing(row, column), place, types[static_cast<std::size_t>(type)]});
  }

  void addStreet(const std::string& from, const std::string& to, bool main, double speed) {
    const int lanes = main ? spec_.lanes : 1;
    plan_.edges.push_back({from + "_" + to, from, to, lanes, speed, main ? 9 : 5, {}, false});
    plan_.edges.push_back({to + "_" + from, to, from, lanes, speed, main ? 9 : 5, {}, false});
    roads_.push_back({from, to});
    roads_.push_back({to, from});
  }

  /// A street from a crossing out of the district.
  std::string addEnd(const std::string& name, int row, int column, double heading) {
    const Eigen::Vector3d from =
        plan_.nodes[static_cast<std::size_t>(row * columns_ + column)].position;
    const double turn = draws_.uniform(-0.25, 0.25);
    const Eigen::Vector2d offset =
        draws_.uniform(95.0, 130.0) * geometry::direction(heading + turn);
    const double height = spec_.elevation ? draws_.uniform(-3.0, 3.0) : 0.0;
    plan_.nodes.push_back({name, {from.x() + offset.x(), from.y() + offset.y(), height}, ""});
    return name;
  }

  void addStreetAlong(int row) {
    const bool main = row == main_row_;
    const double speed = main ? main_speed_ : drawSmallSpeed(draws_);
    const std::string number = std::to_string(row);
    addStreet(addEnd("w" + number, row, 0, core::kPi), crossing(row, 0), main, speed);
    for (int column = 0; column + 1 < columns_; ++column)
      addStreet(crossing(row, column), crossing(row, column + 1), main, speed);
    addStreet(crossing(row, columns_ - 1), addEnd("e" + number, row, columns_ - 1, 0.0), main,
              speed);
  }

  void addStreetAcross(int column) {
    const double speed = drawSmallSpeed(draws_);
    const std::string number = std::to_string(column);
    addStreet(addEnd("s" + number, 0, column, -0.5 * core::kPi), crossing(0, column), false, speed);
    addStreet(crossing(0, column), crossing(1, column), false, speed);
    addStreet(crossing(1, column), addEnd("n" + number, 1, column, 0.5 * core::kPi), false, speed);
  }

  void addPaths() {
    for (const Road& in : roads_) {
      for (const Road& out : roads_) {
        if (in.to != out.from || in.from == out.to) continue;
        plan_.paths.push_back({{in.from + "_" + in.to, out.from + "_" + out.to}, ""});
      }
    }
  }

  const NetworkSpec& spec_;
  int columns_;
  int main_row_;
  Draws& draws_;
  double main_speed_ = 13.89;  ///< [m/s]
  RoadPlan plan_;
  std::vector<Road> roads_;
};

}  // namespace

RoadPlan drawDistrict(const NetworkSpec& spec, Draws& draws) {
  return District(spec, draws).plan();
}

namespace {

std::string gridNode(int column, int row) {
  return std::string(1, static_cast<char>('A' + column)) + std::to_string(row);
}

/// Both directions between two crossings.
void addGridRoad(const std::string& first, const std::string& second, int priority,
                 RoadPlan& plan) {
  PlanEdge edge;
  edge.priority = priority;
  edge.id = first + second;
  edge.from = first;
  edge.to = second;
  plan.edges.push_back(edge);
  std::swap(edge.from, edge.to);
  edge.id = second + first;
  plan.edges.push_back(edge);
}

}  // namespace

RoadPlan gridPlan(const std::string& name, int count, double spacing) {
  constexpr int kMain = 9;
  constexpr int kSide = 5;
  RoadPlan plan;
  plan.name = name;
  plan.text = "A regular grid of crossings";
  for (int column = 0; column < count; ++column) {
    for (int row = 0; row < count; ++row) {
      const Eigen::Vector3d position(column * spacing, row * spacing, 0.0);
      plan.nodes.push_back({gridNode(column, row), position, "priority"});
      if (column > 0) addGridRoad(gridNode(column - 1, row), gridNode(column, row), kMain, plan);
      if (row > 0) addGridRoad(gridNode(column, row - 1), gridNode(column, row), kSide, plan);
    }
  }
  return plan;
}

}  // namespace cdiff::suite
