// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <algorithm>

#include "e2e_cdiff/core/angle.h"
#include "suite/network_kinds.h"

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

}  // namespace cdiff::suite
