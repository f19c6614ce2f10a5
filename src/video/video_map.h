// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <deque>
#include <map>
#include <opencv2/core.hpp>
#include <string>
#include <utility>
#include <vector>

#include "page/pictures/map_canvas.h"
#include "session/session_observer.h"
#include "session/session_setup.h"
#include "video/video_highlights.h"

namespace cdiff::video {

/// The world from above around the ego as pixels, for the video: drivable area, lanes, ego route,
/// trails of the last seconds, conflict points, contacts, vehicles. Map frame, north up, a fixed
/// scale.
class VideoMap {
 public:
  /// `setup` must outlive the map. `size` (width, height) [pixels].
  VideoMap(const session::SessionSetup& setup, const cv::Size& size);
  /// Every tick in order.
  void observe(const session::TickRecord& record);
  /// Draws the last tick into `picture`, 8-bit blue, green, red, of the map's size. The ego's
  /// center lies in the middle; without an ego, what was there last.
  /// Contacts are marked with who touched whom.
  void draw(cv::Mat picture, const std::deque<ContactMark>& contacts) const;

 private:
  using Polygons = std::vector<std::vector<cv::Point>>;
  void drawRoad(cv::Mat picture, const page::MapCanvas& canvas) const;
  void drawRoute(cv::Mat picture, const page::MapCanvas& canvas) const;
  void drawTrails(cv::Mat picture, const page::MapCanvas& canvas) const;
  void drawConflicts(cv::Mat picture, const page::MapCanvas& canvas) const;
  void drawVehicle(cv::Mat picture, const page::MapCanvas& canvas,
                   const traffic::Vehicle& vehicle) const;
  void drawScale(cv::Mat picture, const page::MapCanvas& canvas) const;
  const std::vector<page::Points>& ringsAt(double elevation) const;

  /// Where a vehicle was and when [s].
  using Trail = std::deque<std::pair<double, Eigen::Vector2d>>;
  const session::SessionSetup& setup_;
  cv::Size size_;
  std::vector<page::Points> lanes_;
  mutable std::map<int, std::vector<page::Points>> rings_;  ///< by whole meters of elevation
  traffic::TrafficSnapshot snapshot_;                       ///< the last one
  Eigen::Vector2d center_ = Eigen::Vector2d::Zero();
  double elevation_ = 0.0;  ///< of the ego [m]
  std::map<std::string, Trail> trails_;
  std::vector<cbv::CbvAssignment> assignments_;
};

}  // namespace cdiff::video
