// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cstdio>
#include <limits>
#include <sstream>
#include <stdexcept>

#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/dynamics/pedal_map.h"

namespace cdiff::dynamics {
namespace {

const std::vector<double> kSpeeds = {0.0, 0.5, 2.0, 5.0, 8.0, 13.9, 25.0, 39.0};

TEST(PedalMap, AccelerationIsThatOfTheModelsNextTick) {
  const BicycleModel model;
  for (const double speed : kSpeeds) {
    const traffic::ControlAction action{0.7, 0.0, 0.0};
    EXPECT_DOUBLE_EQ(accelerationOf(model, speed, action),
                     (model.nextSpeed(speed, action) - speed) / 0.05);
  }
  // Full braking is capped at 8 m/s^2.
  EXPECT_NEAR(accelerationOf(model, 8.0, {0.0, 0.0, 1.0}), -8.0, 1e-9);
}

TEST(PedalMap, PedalsGiveTheAccelerationThatIsWithinReach) {
  const BicycleModel model;
  for (const double speed : kSpeeds) {
    const double weakest = accelerationOf(model, speed, {0.3, 0.0, 0.0});
    const double full = accelerationOf(model, speed, {0.0, 0.0, 1.0});
    double strongest = weakest;
    for (int i = 0; i <= 700; ++i)
      strongest = std::max(strongest, accelerationOf(model, speed, {0.3 + 0.001 * i, 0.0, 0.0}));
    for (double wanted = -7.9; wanted < 4.0; wanted += 0.1) {
      const bool reached =
          wanted < 0.0 ? wanted >= full : wanted > weakest && wanted < strongest - 0.02;
      if (!reached) continue;
      const traffic::ControlAction action = pedalsFor(model, speed, wanted);
      EXPECT_TRUE(action.valid());
      EXPECT_EQ(action.throttle * action.brake, 0.0);
      EXPECT_NEAR(accelerationOf(model, speed, action), wanted, 1e-6) << speed << " m/s";
    }
  }
}

TEST(PedalMap, BeyondReachIsTheStrongestPedal) {
  const BicycleModel model;
  EXPECT_EQ(pedalsFor(model, 8.0, -100.0), (traffic::ControlAction{0.0, 0.0, 1.0}));
  EXPECT_EQ(pedalsFor(model, 0.0, -1.0), (traffic::ControlAction{0.0, 0.0, 1.0}));
  EXPECT_EQ(pedalsFor(model, 5.0, 100.0), (traffic::ControlAction{1.0, 0.0, 0.0}));
  EXPECT_EQ(pedalsFor(model, 8.0, 0.0), (traffic::ControlAction{0.0, 0.0, 0.0}));
  EXPECT_GT(pedalsFor(model, 0.0, 1.0).throttle, 0.3);
  EXPECT_THROW(pedalsFor(model, -1.0, 0.0), std::invalid_argument);
  EXPECT_THROW(pedalsFor(model, 1.0, std::numeric_limits<double>::quiet_NaN()),
               std::invalid_argument);
}

TEST(PedalMap, SteerGivesTheCurvature) {
  const BicycleModel model;
  const double largest = largestCurvature(model);
  // sin(atan(1.4178275 / 1.327058485 tan(0.36848336))) / 1.4178275.
  EXPECT_NEAR(1.0 / largest, 3.717, 1e-3);
  for (const double curvature : {-largest, -0.1, 0.0, 0.02, largest}) {
    traffic::VehicleState state;
    state.speed = 4.0;
    const traffic::VehicleState next =
        model.step(state, {0.0, steerFor(model, curvature), 0.0}, 0.05);
    EXPECT_NEAR(core::angleDifference(next.heading, state.heading), 4.0 * 0.05 * curvature, 1e-9);
  }
  EXPECT_THROW(steerFor(model, 1.01 * largest), std::invalid_argument);
}

/// What a Python program prints.
std::string printed(const std::string& program) {
  const std::string command =
      "PYTHONPATH=" E2E_CDIFF_PEDAL_MAP " /usr/bin/python3 -B -c '" + program + "'";
  std::FILE* pipe = popen(command.c_str(), "r");
  std::string text;
  char part[4096];
  while (std::fgets(part, sizeof(part), pipe) != nullptr) text += part;
  EXPECT_EQ(pclose(pipe), 0);
  return text;
}

TEST(PedalMap, PythonSaysTheSame) {
  const BicycleModel model;
  std::istringstream lines(
      printed("from pedal_map import *\n"
              "for i in range(0, 40):\n"
              "  for a in range(-90, 50, 7):\n"
              "    t, b = pedals_for(i, a / 10)\n"
              "    print(i, a / 10, repr(t), repr(b), repr(acceleration_of(i, t, b)), "
              "repr(steer_for(a / 500)))\n"));
  double speed = 0.0;
  double wanted = 0.0;
  double throttle = 0.0;
  double brake = 0.0;
  double reached = 0.0;
  double steer = 0.0;
  int rows = 0;
  while (lines >> speed >> wanted >> throttle >> brake >> reached >> steer) {
    ++rows;
    const traffic::ControlAction action = pedalsFor(model, speed, wanted);
    EXPECT_NEAR(throttle, action.throttle, 1e-9) << speed << " " << wanted;
    EXPECT_NEAR(brake, action.brake, 1e-9) << speed << " " << wanted;
    EXPECT_NEAR(reached, accelerationOf(model, speed, action), 1e-7) << speed << " " << wanted;
    EXPECT_NEAR(steer, steerFor(model, wanted / 50.0), 1e-9);
  }
  EXPECT_EQ(rows, 40 * 20);
}

}  // namespace
}  // namespace cdiff::dynamics
