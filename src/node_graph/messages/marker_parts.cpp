// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/messages/marker_parts.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "node_graph/messages/traffic_conversions.h"

namespace cdiff::node_graph {
namespace {

using visualization_msgs::Marker;

constexpr double kMarkerLifetime = 0.5;  // [s] of simulated time
constexpr double kLetterWidth = 0.48;    // of a capital's height, on average
constexpr double kArrowSpacing = 12.0;   // [m] along a route
constexpr double kRouteLift = 0.10;      // [m] above the road

std_msgs::ColorRGBA toColor(const MarkerColor& color) {
  std_msgs::ColorRGBA message;
  message.r = color.red;
  message.g = color.green;
  message.b = color.blue;
  message.a = color.alpha;
  return message;
}

}  // namespace

const MarkerColor& markerColorOf(traffic::VehicleRole role) {
  if (role == traffic::VehicleRole::kEgo) return marker_color::kEgo;
  return role == traffic::VehicleRole::kCbv ? marker_color::kCbv : marker_color::kBackground;
}

Marker makeMarker(const std::string& marker_namespace, int id, int type, const MarkerColor& color) {
  Marker marker;
  marker.header.frame_id = frameId(kMapFrame);
  marker.ns = marker_namespace;
  marker.id = id;
  marker.type = type;
  marker.action = Marker::ADD;
  marker.pose.orientation.w = 1.0;
  marker.scale.x = marker.scale.y = marker.scale.z = 1.0;
  marker.color = toColor(color);
  return marker;
}

Marker deleteAllMarkers() {
  Marker marker = makeMarker("", 0, Marker::CUBE, {});
  marker.action = Marker::DELETEALL;
  return marker;
}

geometry_msgs::Point toMarkerPoint(const Eigen::Vector3d& position, double lift) {
  geometry_msgs::Point point;
  point.x = position.x();
  point.y = position.y();
  point.z = position.z() + lift;
  return point;
}

void addTriangle(Marker& list, const Eigen::Vector3d& first, const Eigen::Vector3d& second,
                 const Eigen::Vector3d& third, const MarkerColor& color) {
  for (const Eigen::Vector3d* corner : {&first, &second, &third}) {
    list.points.push_back(toMarkerPoint(*corner));
    list.colors.push_back(toColor(color));
  }
}

void addQuad(Marker& list, const Eigen::Vector3d (&corners)[4], const MarkerColor& color) {
  addTriangle(list, corners[0], corners[1], corners[2], color);
  addTriangle(list, corners[0], corners[2], corners[3], color);
}

void addSegment(Marker& list, const Eigen::Vector3d& begin, const Eigen::Vector3d& end,
                const MarkerColor& color) {
  for (const Eigen::Vector3d* point : {&begin, &end}) {
    list.points.push_back(toMarkerPoint(*point));
    list.colors.push_back(toColor(color));
  }
}

Marker boxMarker(const std::string& marker_namespace, int id, const traffic::Vehicle& vehicle,
                 const MarkerColor& color) {
  Marker marker = makeMarker(marker_namespace, id, Marker::CUBE, color);
  marker.pose.position =
      toMarkerPoint(onVehicle(vehicle, {0.0, 0.0, 0.0}), 0.5 * vehicle.dimensions.height);
  marker.pose.orientation.z = std::sin(0.5 * vehicle.state.heading);
  marker.pose.orientation.w = std::cos(0.5 * vehicle.state.heading);
  marker.scale.x = vehicle.dimensions.length;
  marker.scale.y = vehicle.dimensions.width;
  marker.scale.z = vehicle.dimensions.height;
  return marker;
}

Eigen::Vector3d onVehicle(const traffic::Vehicle& vehicle, const Eigen::Vector3d& point) {
  const Eigen::Vector2d place = vehicle.state.pose().toMap(point.head<2>());
  return {place.x(), place.y(), vehicle.state.elevation + point.z()};
}

std::vector<Marker> routeMarkers(const std::string& name, int id, const map::Route& route,
                                 const MarkerColor& color) {
  constexpr double kArrowHalf = 0.9;  // [m]
  Marker line = makeMarker(name, id, Marker::LINE_STRIP, color);
  line.scale.x = 0.45;
  const geometry::Polyline& path = route.path();
  for (const Eigen::Vector3d& point : path.points())
    line.points.push_back(toMarkerPoint(point, kRouteLift));
  Marker arrows = makeMarker(name + "_arrows", id, Marker::TRIANGLE_LIST, color);
  for (double along = kArrowSpacing; along + kArrowHalf < path.length(); along += kArrowSpacing) {
    Eigen::Vector3d middle = path.pointAt(along);
    middle.z() += kRouteLift + 0.02;
    const Eigen::Vector2d forward = kArrowHalf * geometry::direction(path.headingAt(along));
    const Eigen::Vector2d left = geometry::leftNormal(forward);
    const auto at = [&](const Eigen::Vector2d& offset) -> Eigen::Vector3d {
      return middle + Eigen::Vector3d(offset.x(), offset.y(), 0.0);
    };
    addTriangle(arrows, at(1.3 * forward), at(left - 0.7 * forward), at(-left - 0.7 * forward),
                color);
  }
  std::vector<Marker> markers = {line};
  if (!arrows.points.empty()) markers.push_back(arrows);
  return markers;
}

void LabelRoom::reserve(const Eigen::Vector2d& center, const Eigen::Vector2d& half) {
  reserved_.emplace_back(center, half);
}

bool LabelRoom::isFree(const Eigen::Vector2d& center, const Eigen::Vector2d& half) const {
  return std::none_of(reserved_.begin(), reserved_.end(), [&](const auto& other) {
    return ((center - other.first).cwiseAbs().array() < (half + other.second).array()).all();
  });
}

Eigen::Vector2d LabelRoom::take(const Eigen::Vector2d& wanted, const Eigen::Vector2d& half) {
  constexpr int kMostSteps = 40;
  const double step = 0.6 * half.y();
  Eigen::Vector2d place = wanted;
  for (int i = 0; i <= kMostSteps && !isFree(place, half); ++i) {
    const int steps = (i % 2 == 0 ? 1 : -1) * (i / 2 + 1);
    place = wanted + Eigen::Vector2d(0.0, steps * step);
  }
  if (!isFree(place, half)) place = wanted;
  reserve(place, half);
  return place;
}

Labels::Labels(std::string name, LabelRoom* room)
    : name_(std::move(name)),
      room_(room),
      plates_(makeMarker(name_ + "_plates", 0, Marker::TRIANGLE_LIST, marker_color::kPlate)),
      leaders_(makeMarker(name_ + "_plates", 1, Marker::LINE_LIST, marker_color::kPlate)) {
  leaders_.scale.x = 0.12;
}

void Labels::add(int id, const std::string& text, const Eigen::Vector3d& wanted, double size,
                 const MarkerColor& color) {
  const Eigen::Vector2d half(0.5 * size * (kLetterWidth * static_cast<double>(text.size()) + 0.8),
                             0.62 * size);
  Eigen::Vector3d at = wanted;
  if (room_ != nullptr) at.head<2>() = room_->take(wanted.head<2>(), half);
  if ((at - wanted).norm() > 2.0 * half.y()) addSegment(leaders_, wanted, at, color);
  Marker marker = makeMarker(name_, id, Marker::TEXT_VIEW_FACING, color);
  marker.pose.position = toMarkerPoint(at);
  marker.scale.z = size;
  marker.text = text;
  texts_.push_back(marker);
  const double below = -0.1;  // [m]
  const Eigen::Vector3d corners[4] = {at + Eigen::Vector3d(-half.x(), -half.y(), below),
                                      at + Eigen::Vector3d(half.x(), -half.y(), below),
                                      at + Eigen::Vector3d(half.x(), half.y(), below),
                                      at + Eigen::Vector3d(-half.x(), half.y(), below)};
  addQuad(plates_, corners, marker_color::kPlate);
}

std::vector<Marker> Labels::markers() const {
  if (texts_.empty()) return {};
  std::vector<Marker> all = {plates_};
  if (!leaders_.points.empty()) all.push_back(leaders_);
  all.insert(all.end(), texts_.begin(), texts_.end());
  return all;
}

void dateMarkers(std::vector<Marker>& markers, double time) {
  for (Marker& marker : markers) {
    marker.header.stamp = toStamp(time);
    marker.lifetime = ros::Duration(kMarkerLifetime);
  }
}

void appendMarkers(std::vector<Marker>& markers, std::vector<Marker> more) {
  for (Marker& marker : more) markers.push_back(std::move(marker));
}

}  // namespace cdiff::node_graph
