// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <numeric>

#include "planners/course.h"
#include "planners/diffusion/diffusion_options.h"
#include "planners/diffusion/diffusion_planner.h"
#include "planning/surrounding_vehicles.h"
#include "rendering/front_camera.h"
#include "support/front_views.h"

namespace cdiff::planners {
namespace {

/// A profile is compared with `none` draw by draw: same noise, with and without it. Without effect
/// every difference is exactly 0 (the same bytes), so no draw has the asked sign; of an effect that
/// is as often up as down so many draws have it once in 3700 (26 of 32) or once in 480 (14 of 16)
/// sets; with the wrong sign most have not. Signs, because the effect is much larger in some draws
/// than in most: a mean would be that of a few.
struct Draws {
  int count;
  int least;  ///< with the asked sign
};
Draws drawsOf(const std::string& mode) { return mode == "paper" ? Draws{16, 14} : Draws{32, 26}; }

/// Places that the vehicle reaches when it executes the plan (map frame), 0.1 s apart.
std::vector<Eigen::Vector2d> drivenPlaces(const traffic::Vehicle& vehicle,
                                          const planning::PlannedAction& planned) {
  const dynamics::BicycleModel model;
  traffic::VehicleState state = vehicle.state;
  std::vector<Eigen::Vector2d> places;
  for (const planning::RolloutPoint& point : planned.rollout) {
    state = model.step(state, point.action, 0.1);
    places.push_back(state.position);
  }
  return places;
}

/// How many of the first 16 places that a plan's actions lead to have a corner of the box off the
/// area.
int rowsOffTheRoad(const traffic::Vehicle& vehicle, const planning::PlannedAction& planned,
                   const map::DrivableArea& area) {
  const dynamics::BicycleModel model;
  traffic::Vehicle moved = vehicle;
  int off = 0;
  for (std::size_t row = 0; row < 16; ++row) {
    const traffic::ControlAction& action = planned.rollout[row].action;
    moved.state = model.step(model.step(moved.state, action, 0.05), action, 0.05);
    const auto corners = moved.box().corners();
    off += std::any_of(corners.begin(), corners.end(),
                       [&](const Eigen::Vector2d& corner) { return !area.contains(corner); })
               ? 1
               : 0;
  }
  return off;
}

/// Two lanes along +x, y = 0 and y = 3.2; a CBV on the right one, driven by the shipped model, and
/// an ego beside and ahead on the left one.
class GuidedPlans : public ::testing::Test {
 protected:
  GuidedPlans() {
    snapshot_.vehicles = {testing::vehicleAt("ego", 36.0, 3.2, 0.0, 6.0),
                          testing::vehicleAt("cbv", 30.0, 0.0, 0.0, 6.0)};
    snapshot_.vehicles[0].role = traffic::VehicleRole::kEgo;
    snapshot_.vehicles[1].role = traffic::VehicleRole::kCbv;
    snapshot_.vehicles[1].cbv_slot = 0;
  }
  const traffic::Vehicle& ego() const { return snapshot_.vehicles[0]; }
  traffic::Vehicle& cbv() { return snapshot_.vehicles[1]; }

  using Measure = std::function<double(const std::vector<Eigen::Vector2d>&)>;

  /// `measure` of the plan of each draw: the same decision with the noise of another tick.
  std::vector<double> measured(const std::string& profile, const DiffusionOptions& options,
                               const Measure& measure) {
    traffic::CameraImage image = rendering::FrontCamera({}, network_).render(snapshot_, cbv());
    DiffusionPlanner planner(options, guidance::loadProfile(profile), {},
                             planning::PlanningContext{network_, area_});
    std::vector<double> values;
    for (int draw = 0; draw < drawsOf(options.sampler.mode).count; ++draw) {
      snapshot_.tick = image.tick = static_cast<std::uint64_t>(2 * draw);
      const auto planned =
          planner.plan(snapshot_, {{0, &cbv(), &route_, 8.0, test::frontViews(&image)}});
      EXPECT_EQ(planned[0].fault, "");
      values.push_back(measure(drivenPlaces(cbv(), planned[0])));
    }
    return values;
  }

  /// `measure` is larger (`sign` 1) or smaller (-1) with the profile than with `none`, in the mean
  /// and in almost all draws.
  void expectEffect(const std::string& profile, double sign, const Measure& measure) {
    for (const char* mode : {"real_time", "paper"}) {
      SCOPED_TRACE(profile + ", " + mode);
      DiffusionOptions options;
      options.sampler.mode = mode;
      options.conditioning = "image_route";  // else the profile decides it, too
      const std::vector<double> without = measured("none", options, measure);
      const std::vector<double> with = measured(profile, options, measure);
      int right = 0;
      double sum = 0.0;
      for (std::size_t i = 0; i < with.size(); ++i) {
        sum += with[i] - without[i];
        if (sign * (with[i] - without[i]) > 0.0) ++right;
      }
      EXPECT_GE(right, drawsOf(mode).least);
      EXPECT_GT(sign * sum, 0.0);
      RecordProperty(std::string(mode) + "_right", right);
      RecordProperty(std::string(mode) + "_mean_mm",
                     static_cast<int>(1000.0 * sum / drawsOf(mode).count));
    }
  }

  /// rowsOffTheRoad of the plan of each of 16 draws, of eight candidates without guidance.
  std::vector<int> rowsOffWith(double road_horizon) {
    guidance::GuidanceOptions guidance;
    guidance.candidates = 8;
    guidance.road_horizon = road_horizon;
    traffic::CameraImage image = rendering::FrontCamera({}, network_).render(snapshot_, cbv());
    DiffusionOptions options;
    options.conditioning = "image";
    DiffusionPlanner planner(options, guidance, {}, planning::PlanningContext{network_, area_});
    std::vector<int> rows;
    for (std::uint64_t draw = 0; draw < 16; ++draw) {
      // Not consecutive decisions: no plan is the last one of the next.
      snapshot_.tick = image.tick = 100 * draw;
      const auto planned =
          planner.plan(snapshot_, {{0, &cbv(), &route_, 8.0, test::frontViews(&image)}});
      rows.push_back(rowsOffTheRoad(cbv(), planned[0], area_));
    }
    return rows;
  }

  /// Mean distance to where the ego is forecast to be.
  double distanceToEgo(const std::vector<Eigen::Vector2d>& places) const {
    const auto forecast = planning::forecastMotion(ego(), network_, {}, places.size());
    double sum = 0.0;
    for (std::size_t i = 0; i < places.size(); ++i)
      sum += (places[i] - forecast[i].position).norm();
    return sum / static_cast<double>(places.size());
  }
  /// Mean distance beyond the area's margin of 1.2 m to the right border, at y = -1.6.
  static double beyondMargin(const std::vector<Eigen::Vector2d>& places) {
    double sum = 0.0;
    for (const Eigen::Vector2d& place : places) sum += std::max(0.0, -0.4 - place.y());
    return sum / static_cast<double>(places.size());
  }

  map::RoadNetwork network_ =
      testing::makeNetwork({{"road", testing::straight(-50.0, 0.0, 250.0, 0.0)},
                            {"left", testing::straight(-50.0, 3.2, 250.0, 3.2)}});
  map::DrivableArea area_{network_};
  map::Route route_ = testing::routeAlong(network_, {"road"});
  traffic::TrafficSnapshot snapshot_;
};

TEST_F(GuidedPlans, SafetyCriticalApproachesTheEgo) {
  expectEffect("safety_critical", -1.0, [&](const auto& places) { return distanceToEgo(places); });
}

TEST_F(GuidedPlans, CollisionAvoidanceDepartsFromTheEgo) {
  expectEffect("ablation_collision", 1.0,
               [&](const auto& places) { return distanceToEgo(places); });
}

TEST_F(GuidedPlans, DrivableAreaPullsAnOffsetPlanIn) {
  cbv().state.position.y() = -1.2;  // 0.4 m from the border
  expectEffect("ablation_drivable", -1.0, beyondMargin);
}

TEST_F(GuidedPlans, CandidatesThatKeepOnTheRoadComeFirst) {
  cbv().state.position.y() = 0.5;
  cbv().state.heading = -0.25;  // toward the border, at y = -1.6
  const std::vector<int> any = rowsOffWith(0.0);
  const std::vector<int> road_first = rowsOffWith(1.6);
  for (std::size_t draw = 0; draw < any.size(); ++draw)
    EXPECT_LE(road_first[draw], any[draw]) << "draw " << draw;
  EXPECT_LT(std::accumulate(road_first.begin(), road_first.end(), 0),
            std::accumulate(any.begin(), any.end(), 0));
}

}  // namespace
}  // namespace cdiff::planners
