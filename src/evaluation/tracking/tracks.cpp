// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/tracking/tracks.h"

#include <algorithm>
#include <cmath>

#include "e2e_cdiff/core/angle.h"
#include "suite/network_generator.h"

namespace cdiff::evaluation {
namespace {

using suite::Draws;
using suite::RoadLine;

constexpr double kMargin = 5.0;        // of the line before the start and after the stop [m]
constexpr double kDeceleration = 2.0;  // of the stop [m/s^2]

double drawAngle(Draws& draws, double low, double high) {
  return core::degreesToRadians(draws.uniform(low, high));
}

RoadLine drawLine(const std::string& kind, Draws& draws) {
  RoadLine line(Eigen::Vector2d::Zero(), 0.0);
  line.straight(20.0);
  // `side`: 1 to the left, -1 to the right; angles in degrees, radii in m.
  const auto arc = [&](double radius_low, double radius_high, double side, double low,
                       double high) {
    const double angle = side * drawAngle(draws, low, high);
    line.arc(draws.uniform(radius_low, radius_high), angle);
  };
  if (kind == "straight") {
    line.straight(draws.uniform(30.0, 70.0));
  } else if (kind == "left") {
    arc(7.0, 16.0, 1.0, 60.0, 110.0);
  } else if (kind == "right") {
    arc(5.0, 11.0, -1.0, 60.0, 110.0);
  } else if (kind == "s_curve") {
    const double side = draws.sign();
    arc(10.0, 40.0, side, 20.0, 60.0);
    arc(10.0, 40.0, -side, 20.0, 60.0);
  } else {
    arc(8.0, 14.0, -1.0, 30.0, 60.0);
    arc(9.0, 16.0, 1.0, 60.0, 250.0);
    arc(8.0, 14.0, -1.0, 30.0, 60.0);
  }
  return line.straight(30.0);
}

Track drawTrack(const std::string& kind, std::uint32_t number, Draws& draws) {
  constexpr Eigen::Index kLongPlan = 80;
  constexpr Eigen::Index kShortPlan = 32;
  Track track;
  track.kind = kind;
  track.number = number;
  track.line = geometry::Polyline(drawLine(kind, draws).points());
  track.speed = draws.uniform(4.0, kind == "straight" ? 14.0 : 9.0);
  track.plan_rows = number % 2 == 0 ? kLongPlan : kShortPlan;
  track.start.position = {kMargin, draws.uniform(-0.4, 0.4)};
  track.start.heading = draws.uniform(-0.1, 0.1);
  track.acceleration = draws.uniform(0.5, 2.0);
  track.start.speed = draws.chance(0.5) ? track.speed : 0.0;
  return track;
}

}  // namespace

double Track::stop() const { return line.length() - kMargin; }

double Track::speedAt(double arc_length) const {
  constexpr double kFirstMove = 0.02;  // whoever stands moves on at all [m]
  const double left = std::max(0.0, stop() - arc_length);
  const double driven = std::max(kFirstMove, arc_length - kMargin);
  const double reached = std::hypot(start.speed, std::sqrt(2.0 * acceleration * driven));
  return std::min({speed, reached, std::sqrt(2.0 * kDeceleration * left)});
}

double Track::duration() const {
  return (stop() - kMargin) / speed + speed / acceleration + speed / kDeceleration;
}

const std::vector<std::string>& trackKinds() {
  static const std::vector<std::string> kinds = {"straight", "left", "right", "s_curve",
                                                 "roundabout"};
  return kinds;
}

std::vector<Track> drawTracks(const core::RandomStream& random, int each) {
  std::vector<Track> tracks;
  for (const std::string& kind : trackKinds()) {
    for (int i = 0; i < each; ++i) {
      const auto number = static_cast<std::uint32_t>(tracks.size());
      Draws draws(random, number);
      tracks.push_back(drawTrack(kind, number, draws));
    }
  }
  return tracks;
}

Eigen::MatrixX2d planOn(const Track& track, const traffic::VehicleState& state, double arc_length,
                        const core::RandomStream& random, std::uint32_t decision) {
  constexpr double kBeside = 0.05;  // [m]
  constexpr double kApart = 0.1;    // [m/s]
  const core::RandomKey key{track.number, decision, 0};
  const double beside = kBeside * random.normal(key, 0);
  const double apart = kApart * random.normal(key, 1);
  Eigen::MatrixX2d places(track.plan_rows, 2);
  double s = arc_length;
  for (Eigen::Index row = 0; row < places.rows(); ++row) {
    s += track.speedAt(s) * traffic::kRolloutStep;
    const double time = static_cast<double>(row + 1) * traffic::kRolloutStep;
    const Eigen::Vector2d left = geometry::leftNormal(geometry::direction(track.line.headingAt(s)));
    const Eigen::Vector2d place = track.line.positionAt(s) + (beside + apart * time) * left;
    places.row(row) = state.pose().toBody(place).transpose();
  }
  return places;
}

}  // namespace cdiff::evaluation
