// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>
#include <unordered_map>
#include <vector>

#include "e2e_cdiff/traffic/traffic_snapshot.h"
#include "rendering/canvas.h"
#include "rendering/road_scene.h"

namespace cdiff::rendering {

// Traffic lights in the images of cameras.

/// The color of a lit lamp of a traffic light; kDark where none is lit.
enum class LampColor { kDark, kRed, kYellow, kGreen };

/// SUMO's letter as a color: r s red, y u yellow, g G green, anything else dark.
LampColor lampColorOf(char letter);

/// The end of a lane that a light controls.
struct SignalHead {
  Eigen::Vector3d stop = Eigen::Vector3d::Zero();      ///< middle of the stop line [m]
  Eigen::Vector2d forward = Eigen::Vector2d::UnitX();  ///< direction of the lane there
  double width = 0.0;                                  ///< width of the lane [m]
  int signal = 0;                                      ///< index of the light
  int link = 0;                                        ///< position in the light's state
};

/// A mast beside the road with an arm above the lanes.
struct SignalMast {
  Eigen::Vector3d base = Eigen::Vector3d::Zero();
  Eigen::Vector3d top = Eigen::Vector3d::Zero();
  Eigen::Vector3d arm_end = Eigen::Vector3d::Zero();
};

/// Traffic lights: a stop line in the light's color at the end of each lane that one controls, and
/// a lamp above the lane, 2.5 m behind the line, on a mast at the right of the road.
class SignalHeads {
 public:
  explicit SignalHeads(const map::RoadNetwork& network);
  /// Reads the colors and finds what the views may see; the two draws show that in one of them.
  void look(const std::vector<View>& views, const std::vector<traffic::SignalState>& signals);
  void drawStopLines(std::size_t index, const View& view, Canvas& canvas) const;
  void drawLamps(std::size_t index, const View& view, Canvas& canvas) const;

  /// The ends of all lanes that a light controls.
  const std::vector<SignalHead>& heads() const { return heads_; }
  /// Their colors, in that order.
  std::vector<LampColor> colorsOf(const std::vector<traffic::SignalState>& signals);

 private:
  void read(const std::vector<traffic::SignalState>& signals);
  void addLane(const map::Lane& lane);
  void addMast(const map::RoadNetwork& network, const std::string& edge);
  LampColor colorOf(const SignalHead& head) const;
  void drawLamp(const SignalHead& head, const View& view, Canvas& canvas) const;

  std::vector<SignalHead> heads_;
  std::vector<SignalMast> masts_;
  SpatialGrid head_grid_;
  SpatialGrid mast_grid_;
  std::unordered_map<std::string, int> signal_by_id_;
  std::vector<const std::string*> states_;       ///< by signal; of the snapshot looked at
  std::vector<std::vector<int>> visible_heads_;  ///< by view
  std::vector<std::vector<int>> visible_masts_;  ///< by view
};

}  // namespace cdiff::rendering
