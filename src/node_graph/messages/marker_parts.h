// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>
#include <vector>

#include "e2e_cdiff/map/route.h"
#include "e2e_cdiff/traffic/vehicle.h"
#include "visualization_msgs/MarkerArray.h"

namespace cdiff::node_graph {

// What markers for rviz are made of. Roads are dark gray and everything on them is bright; texts
// stand on dark plates. So a light background of rviz and a dark one both do.

/// A color of a marker, each part in [0, 1].
struct MarkerColor {
  float red = 0.0F;
  float green = 0.0F;
  float blue = 0.0F;
  float alpha = 1.0F;
};

namespace marker_color {
inline constexpr MarkerColor kEgo{1.0F, 0.28F, 0.22F, 1.0F};
inline constexpr MarkerColor kEgoRoute{0.78F, 0.28F, 0.24F, 1.0F};
inline constexpr MarkerColor kCbvRoute{0.62F, 0.34F, 0.78F, 1.0F};
inline constexpr MarkerColor kCbv{0.82F, 0.38F, 1.0F, 1.0F};
inline constexpr MarkerColor kBackground{0.30F, 0.62F, 1.0F, 1.0F};
inline constexpr MarkerColor kConflict{1.0F, 0.85F, 0.10F, 1.0F};
inline constexpr MarkerColor kContact{1.0F, 0.50F, 0.0F, 1.0F};
inline constexpr MarkerColor kUnguided{0.30F, 0.95F, 0.45F, 1.0F};
inline constexpr MarkerColor kWhite{1.0F, 1.0F, 1.0F, 1.0F};
inline constexpr MarkerColor kSoft{0.72F, 0.75F, 0.80F, 1.0F};
inline constexpr MarkerColor kPlate{0.07F, 0.08F, 0.10F, 0.85F};
}  // namespace marker_color

/// Red for the ego, purple for CBVs, blue for background vehicles.
const MarkerColor& markerColorOf(traffic::VehicleRole role);

/// An object of that type in `map`, at its origin, of scale 1.
visualization_msgs::Marker makeMarker(const std::string& marker_namespace, int id, int type,
                                      const MarkerColor& color);
/// Clears what the topic showed.
visualization_msgs::Marker deleteAllMarkers();

/// `position` [m], `lift` [m] higher: what lies on a road is lifted, so that it stays visible.
geometry_msgs::Point toMarkerPoint(const Eigen::Vector3d& position, double lift = 0.0);

/// To a TRIANGLE_LIST, in a color of their own.
void addTriangle(visualization_msgs::Marker& list, const Eigen::Vector3d& first,
                 const Eigen::Vector3d& second, const Eigen::Vector3d& third,
                 const MarkerColor& color);
/// The same of a flat piece with four corners, in turn.
void addQuad(visualization_msgs::Marker& list, const Eigen::Vector3d (&corners)[4],
             const MarkerColor& color);
/// To a LINE_LIST, in a color of its own.
void addSegment(visualization_msgs::Marker& list, const Eigen::Vector3d& begin,
                const Eigen::Vector3d& end, const MarkerColor& color);

/// A vehicle's box.
visualization_msgs::Marker boxMarker(const std::string& marker_namespace, int id,
                                     const traffic::Vehicle& vehicle, const MarkerColor& color);

/// A point of a vehicle's frame (x forward, y left, z above the road [m]) in `map`.
Eigen::Vector3d onVehicle(const traffic::Vehicle& vehicle, const Eigen::Vector3d& point);

/// A route as a line with arrowheads that point along it; namespaces `name` and `name`_arrows.
std::vector<visualization_msgs::Marker> routeMarkers(const std::string& name, int id,
                                                     const map::Route& route,
                                                     const MarkerColor& color);

/// Free room for labels in a picture from above: what is reserved is kept clear [m].
class LabelRoom {
 public:
  /// A rectangle of the map with that center and half its width and height.
  void reserve(const Eigen::Vector2d& center, const Eigen::Vector2d& half);
  /// The free center nearest to `wanted`, straight above or below it, which is then reserved;
  /// `wanted` itself where none is near.
  Eigen::Vector2d take(const Eigen::Vector2d& wanted, const Eigen::Vector2d& half);

 private:
  bool isFree(const Eigen::Vector2d& center, const Eigen::Vector2d& half) const;
  /// Center and half size.
  std::vector<std::pair<Eigen::Vector2d, Eigen::Vector2d>> reserved_;
};

/// Texts that face the viewer, each on a dark plate that lies below it.
class Labels {
 public:
  /// Plates get namespace `name`_plates. With `room`, which must outlive the object, a text that
  /// would cover something moves, and a thin line leads to where it belongs.
  explicit Labels(std::string name, LabelRoom* room = nullptr);
  /// `size`: height of a capital [m]; the text's middle lies at `wanted` (map frame).
  void add(int id, const std::string& text, const Eigen::Vector3d& wanted, double size,
           const MarkerColor& color);
  /// The plates as one marker, the lines, and the texts.
  std::vector<visualization_msgs::Marker> markers() const;

 private:
  std::string name_;
  LabelRoom* room_;
  visualization_msgs::Marker plates_;
  visualization_msgs::Marker leaders_;
  std::vector<visualization_msgs::Marker> texts_;
};

/// All with that stamp [s], and gone after 0.5 s of simulated time unless they come again.
void dateMarkers(std::vector<visualization_msgs::Marker>& markers, double time);

/// Moves `more` to the end of `markers`.
void appendMarkers(std::vector<visualization_msgs::Marker>& markers,
                   std::vector<visualization_msgs::Marker> more);

}  // namespace cdiff::node_graph
