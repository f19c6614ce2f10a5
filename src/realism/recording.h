// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <vector>

#include "e2e_cdiff/geometry/shapes.h"
#include "realism/likelihood.h"

namespace cdiff::realism {

// Courses of vehicles on one clock, every 0.1 s, whatever they come from: a session, its trace or
// bag, a file of recorded traffic (SI units, a metric frame of the recording's own).

/// From one step of a recording to the next [s].
inline constexpr double kStep = 0.1;

/// Where a vehicle is at one step.
struct TrackState {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  ///< center of the box [m]
  double heading = 0.0;                                ///< [rad]
  double elevation = 0.0;                              ///< [m]
};

/// The states of one vehicle at consecutive steps, without gaps (map frame, SI units).
struct Track {
  std::string id;
  std::string role = {};  ///< who drives it, as a trace says; empty in recorded traffic
  double length = 4.5;    ///< [m]
  double width = 1.8;     ///< [m]
  std::size_t first = 0;  ///< step of the first state
  std::vector<TrackState> states = {};
  /// Steps at which, or between which and the next, a session had an overlap of this vehicle with
  /// another; none in recorded traffic, where steps are all there is.
  std::set<std::size_t> contacts = {};

  bool touchesAt(std::size_t step) const { return contacts.count(step) != 0; }
  /// Adds the step to `contacts` where the track covers it.
  void noteContact(std::size_t step) {
    if (covers(step)) contacts.insert(step);
  }
  std::size_t end() const { return first + states.size(); }
  bool covers(std::size_t step) const { return step >= first && step < end(); }
  const TrackState& at(std::size_t step) const { return states[step - first]; }
  geometry::OrientedBox box(std::size_t step) const;
};

/// All vehicles of one session or one recording.
struct Recording {
  std::string name;
  std::string site;  ///< where it was recorded
  std::vector<Track> tracks;
};

/// Derivatives of a track at each of its states; NaN where there is none.
struct Motion {
  Series speed;             ///< [m/s]
  Series acceleration;      ///< [m/s^2]
  Series yaw_rate;          ///< [rad/s]
  Series yaw_acceleration;  ///< [rad/s^2]
};

/// As in the challenge: central differences of places and headings, and of those again. The first
/// and last states have no speed, the first and last two no acceleration.
Motion centralMotion(const Track& track);

/// States that a smoothed derivative is made of.
inline constexpr std::size_t kSmoothingWindow = 11;

/// For tracks of different origin: Savitzky-Golay filters (11 states, quadratic; the ends take the
/// last whole window) on x and y, then on speed and on heading, and on yaw rate. The heading is the
/// direction of motion above 1 m/s, else that of the nearest moving state, else as it is given:
/// it replaces the headings of the track. Nothing but NaN for tracks that are shorter.
Motion smoothedMotion(Track& track);

/// Derivative of equally spaced values by that filter [1/s]; empty below 11 values.
Series smoothedDerivative(const Series& values);

// Features of a vehicle among the others of its recording (SI units).

/// Beyond every histogram: no other vehicle is there [m].
inline constexpr double kNobody = 1e10;
/// Of time to collision [s].
inline constexpr double kLongestTime = 5.0;

/// Distance of two boxes [m]; negative where they overlap: by how much they must be moved apart.
/// That of the origin to the border of their Minkowski difference.
double signedDistance(const geometry::OrientedBox& first, const geometry::OrientedBox& second);

/// A vehicle as time to collision sees it.
struct MovingBox {
  geometry::OrientedBox box;
  double speed = 0.0;  ///< along its heading [m/s]
};

/// Gap along its heading to the nearest vehicle ahead of its front divided by the closing speed, at
/// most 5 s [s]. Ahead: headings differ by at most 75 degrees, 10 degrees where they overlap
/// laterally by less than 0.5 m; the lateral extents overlap.
double timeToCollision(const MovingBox& self, const std::vector<MovingBox>& others);

/// Features of one track of a recording at the steps from `begin` to `end`, without those of the
/// map (empty). `motions`: of all tracks. Steps without the track are NaN.
Course courseOf(const Recording& recording, const std::vector<Motion>& motions, std::size_t track,
                std::size_t begin, std::size_t end);

}  // namespace cdiff::realism
