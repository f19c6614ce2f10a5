// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "e2e_cdiff/map/route.h"
#include "e2e_cdiff/metrics/metrics_options.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"

namespace cdiff::metrics {

/// Stop lines that the ego crosses (map frame [m]): red lights run and stop signs not obeyed. A
/// line is a lane's end before a junction; it is crossed when the point 0.8 half lengths behind the
/// ego's center passes it inside the lane's width and on its level.
class StopLines {
 public:
  /// `network` must outlive the object. Of a lane on the ego route the link that the route takes
  /// counts; of another lane all links do, and a rule holds only where it holds for each.
  StopLines(const map::RoadNetwork& network, const map::Route& route,
            const InfractionOptions& options);

  /// One tick of the ego, with the lights' colors.
  void observe(const traffic::Vehicle& ego, const std::vector<traffic::SignalState>& signals);

  /// Lines crossed while the light showed red (r) or red-yellow (u).
  std::size_t redLights() const { return red_lights_; }
  /// Lines with a light crossed, whatever it showed.
  std::size_t lightsCrossed() const { return lights_crossed_; }
  /// Lines with a stop sign crossed without having stopped within the distance before them.
  std::size_t stopSigns() const { return stop_signs_; }
  std::size_t stopSignsCrossed() const { return stop_signs_crossed_; }

 private:
  using Links = std::vector<map::LaneLink>;
  /// The ego against one line: meters beyond it, and beside the lane's centerline.
  struct Place {
    double beyond = 0.0;
    double beside = 0.0;
  };
  Place placeAt(const map::Lane& lane, const Eigen::Vector2d& point) const;
  Links linksOf(map::LaneIndex lane) const;
  bool crosses(const map::Lane& lane, const Eigen::Vector2d& tail) const;
  void noteStop(const traffic::Vehicle& ego, const std::vector<map::LaneIndex>& lanes);
  void cross(map::LaneIndex lane, const std::vector<traffic::SignalState>& signals);

  const map::RoadNetwork& network_;
  InfractionOptions options_;
  std::vector<std::pair<map::LaneIndex, map::LaneIndex>> taken_;  ///< links of the route, sorted
  std::optional<Eigen::Vector2d> last_tail_;
  map::LaneIndex stopped_on_ = map::kNoLane;  ///< lane with a stop sign before whose line it stood
  std::size_t red_lights_ = 0;
  std::size_t lights_crossed_ = 0;
  std::size_t stop_signs_ = 0;
  std::size_t stop_signs_crossed_ = 0;
};

}  // namespace cdiff::metrics
