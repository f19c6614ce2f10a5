// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <limits>
#include <vector>

#include "e2e_cdiff/map/road_network.h"

namespace cdiff::map {

/// Uniform grid over the segments of the centerlines of all lanes that allow cars (map frame [m]);
/// answers which lanes pass near a point.
struct RoadNetwork::SpatialIndex {
  /// What a query searches for.
  struct Query {
    Eigen::Vector2d position = Eigen::Vector2d::Zero();
    double radius = 0.0;                                            ///< [m]
    double elevation = 0.0;                                         ///< [m]
    double level_height = std::numeric_limits<double>::infinity();  ///< [m]
  };
  /// The nearest segment of a lane.
  struct Hit {
    LaneIndex lane = kNoLane;
    int segment = 0;
    double squared_distance = 0.0;  ///< in the plane [m^2]
  };

  explicit SpatialIndex(const std::vector<Lane>& lanes);
  /// One hit for each lane that fits, by lane index.
  std::vector<Hit> find(const Query& query) const;

 private:
  /// A segment with all that its distance needs, so that a query reads the entries alone.
  struct Entry {
    Entry() = default;
    Entry(const std::vector<Lane>& lanes, LaneIndex of_lane, int of_segment);

    LaneIndex lane = kNoLane;
    int segment = 0;
    Eigen::Vector2d start = Eigen::Vector2d::Zero();  ///< [m]
    Eigen::Vector2d along = Eigen::Vector2d::Zero();  ///< to its end [m]
    double squared_length = 0.0;                      ///< in the plane [m^2]
    double elevation = 0.0;                           ///< of its start [m]
    double rise = 0.0;                                ///< from there to its end [m]
  };
  static bool before(const Hit& left, const Hit& right);
  static void keepNearest(const Hit& hit, std::vector<Hit>& hits);
  int columnOf(double x) const;
  int rowOf(double y) const;
  void setBounds(const std::vector<Lane>& lanes);
  template <class Visit>
  void visitCells(const Lane& lane, Visit&& visit) const;

  double cell_size_ = 10.0;  ///< [m]
  Eigen::Vector2d origin_ = Eigen::Vector2d::Zero();
  int columns_ = 1;
  int rows_ = 1;
  std::vector<std::size_t>
      cell_begin_;  ///< entries of cell c: [cell_begin_[c], cell_begin_[c + 1])
  std::vector<Entry> entries_;
};

}  // namespace cdiff::map
