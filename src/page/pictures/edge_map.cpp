// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "page/pictures/edge_map.h"

#include <algorithm>
#include <cmath>

#include "core/markup.h"
#include "core/text.h"
#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::page {
namespace {

using core::Attribute;
using core::element;
using core::Markup;

constexpr double kMapMargin = 15.0;   ///< around the roads [m]
constexpr double kLargestText = 3.6;  ///< height of an edge's name [m]
constexpr double kSmallestText = 1.2;

/// Corners of what is drawn, in the map frame [m].
struct Extent {
  Eigen::Vector2d low = Eigen::Vector2d::Constant(1e300);
  Eigen::Vector2d high = Eigen::Vector2d::Constant(-1e300);
};

Extent extentOf(const map::RoadNetwork& network) {
  Extent extent;
  for (const map::Lane& lane : network.lanes()) {
    if (!lane.allows_cars) continue;
    for (const Eigen::Vector3d& point : lane.centerline.points()) {
      extent.low = extent.low.cwiseMin(point.head<2>());
      extent.high = extent.high.cwiseMax(point.head<2>());
    }
  }
  if (extent.low.x() > extent.high.x())
    throw core::InputError("there is nothing to draw: the network has no lane for cars");
  extent.low.array() -= kMapMargin;
  extent.high.array() += kMapMargin;
  return extent;
}

/// The network in meters, x to the right and y down, from the top left corner.
class EdgeMap {
 public:
  explicit EdgeMap(const map::RoadNetwork& network)
      : network_(network), extent_(extentOf(network)) {}

  std::string draw(const std::optional<map::Route>& route) const {
    constexpr double kPixels = 3.0;  // a meter
    constexpr double kLeastWidth = 900.0;
    const Eigen::Vector2d size = extent_.high - extent_.low;
    const double scale = std::max(kPixels, kLeastWidth / size.x());
    const Markup content =
        element("title", {}, "Road network with the names of its edges") +
        element("rect", {{"width", "100%"}, {"height", "100%"}, {"fill", "#f4f5f2"}}) +
        junctions() + lanes() + (route ? routeMarks(*route) : Markup()) + names() + scaleBar();
    return core::xmlDocument(element("svg",
                                     {{"xmlns", "http://www.w3.org/2000/svg"},
                                      {"width", std::lround(scale * size.x())},
                                      {"height", std::lround(scale * size.y())},
                                      {"viewBox", "0 0 " + place(size)},
                                      {"font-family", "DejaVu Sans, Arial, sans-serif"}},
                                     content));
  }

 private:
  static std::string place(const Eigen::Vector2d& point) {
    return core::formatFixed(point.x(), 2) + " " + core::formatFixed(point.y(), 2);
  }
  Eigen::Vector2d toPicture(const Eigen::Vector2d& point) const {
    return {point.x() - extent_.low.x(), extent_.high.y() - point.y()};
  }
  std::string lineData(const std::vector<Eigen::Vector3d>& points) const {
    std::string data;
    for (const Eigen::Vector3d& point : points)
      data += (data.empty() ? "M" : "L") + place(toPicture(point.head<2>()));
    return data;
  }
  static std::string meters(double value) { return core::formatFixed(value, 2); }

  Markup junctions() const {
    Markup drawn;
    for (const map::Junction& junction : network_.junctions()) {
      if (junction.shape.size() < 3) continue;
      drawn += element("path", {{"d", lineData(junction.shape) + "Z"}, {"fill", "#c9cdd3"}});
    }
    return element("g", {{"class", "junctions"}}, drawn) + "\n";
  }

  Markup lanes() const {
    Markup drawn;
    for (const map::Lane& lane : network_.lanes()) {
      if (!lane.allows_cars) continue;
      drawn += element("path", {{"d", lineData(lane.centerline.points())},
                                {"stroke-width", meters(0.92 * lane.width)}});
    }
    return element("g", {{"class", "lanes"}, {"fill", "none"}, {"stroke", "#c9cdd3"}}, drawn) +
           "\n";
  }

  Markup names() const {
    Markup drawn;
    for (const std::string& id : network_.edgeIds()) {
      std::vector<map::LaneIndex> lanes;
      for (const map::LaneIndex lane : network_.lanesOfEdge(id)) {
        if (network_.lane(lane).allows_cars) lanes.push_back(lane);
      }
      if (!lanes.empty()) drawn += name(id, lanes);
    }
    return element("g",
                   {{"class", "names"},
                    {"text-anchor", "middle"},
                    {"fill", "#14324f"},
                    {"stroke", "#f4f5f2"},
                    {"stroke-width", "0.5"},
                    {"paint-order", "stroke"}},
                   drawn) +
           "\n";
  }

  /// An edge's name on the middle of its lanes, and an arrow to where it leads.
  Markup name(const std::string& id, const std::vector<map::LaneIndex>& lanes) const {
    constexpr double kLetter = 0.62;  // width of a letter per height
    const std::string shown = core::cutText(id, 40);
    const map::Lane& lane = network_.lane(lanes[lanes.size() / 2]);
    const double length = lane.centerline.length();
    const double letters = static_cast<double>(shown.size()) + 2.0;
    const double height =
        std::clamp(0.9 * length / (kLetter * letters), kSmallestText, kLargestText);
    const double heading = lane.centerline.headingAt(0.5 * length);
    const bool forward = std::cos(heading) >= 0.0;  // else the text would stand on its head
    const double turned = -(forward ? heading : heading + core::kPi) / core::kDegree;
    const Eigen::Vector2d middle = toPicture(lane.centerline.positionAt(0.5 * length));
    const std::string tip = "edge " + id + ": " + core::formatFixed(length, 0) + " m, " +
                            std::to_string(lanes.size()) +
                            (lanes.size() == 1 ? " lane, " : " lanes, ") +
                            core::formatFixed(lane.speed_limit, 1) + " m/s";
    return element(
               "text",
               {{"transform", "translate(" + place(middle) + ") rotate(" + meters(turned) + ")"},
                {"dy", meters(0.36 * height)},
                {"font-size", meters(height)}},
               element("title", {}, tip) +
                   Markup(forward ? shown + " \u2192" : "\u2190 " + shown)) +
           "\n";
  }

  Markup routeMarks(const map::Route& route) const {
    const auto& points = route.path().points();
    const auto dot = [&](const Eigen::Vector3d& point, const char* fill, const char* tip) {
      const Eigen::Vector2d at = toPicture(point.head<2>());
      return element("circle",
                     {{"cx", meters(at.x())}, {"cy", meters(at.y())}, {"r", "2.2"}, {"fill", fill}},
                     element("title", {}, tip));
    };
    return element("g", {{"class", "route"}},
                   element("path", {{"d", lineData(points)},
                                    {"fill", "none"},
                                    {"stroke", "#c62828"},
                                    {"stroke-width", "1.6"},
                                    {"stroke-opacity", "0.55"}}) +
                       dot(points.front(), "#c62828", "start of the ego") +
                       dot(points.back(), "#2e7d32", "goal")) +
           "\n";
  }

  Markup scaleBar() const {
    constexpr double kBar = 50.0;  // [m]
    const double bottom = extent_.high.y() - extent_.low.y() - 4.0;
    return element("path", {{"d", "M5 " + meters(bottom) + "h" + meters(kBar)},
                            {"stroke", "#1c2024"},
                            {"stroke-width", "0.6"}}) +
           element("text", {{"x", "5"}, {"y", meters(bottom - 1.2)}, {"font-size", "3.6"}},
                   "50 m; red dot: start, green dot: goal");
  }

  const map::RoadNetwork& network_;
  Extent extent_;
};

}  // namespace

std::string edgeMapSvg(const map::RoadNetwork& network, const std::optional<map::Route>& route) {
  return EdgeMap(network).draw(route);
}

}  // namespace cdiff::page
