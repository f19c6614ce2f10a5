// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "page/pictures/top_view.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/text.h"
#include "e2e_cdiff/core/angle.h"
#include "page/page_parts.h"
#include "page/pictures/attention.h"
#include "page/pictures/charts.h"
#include "page/pictures/map_canvas.h"
#include "page/pictures/perception.h"

namespace cdiff::page {
namespace {

using core::element;
using core::Markup;
using traffic::VehicleRole;

constexpr double kLabelHeight = 15.0;         // [pixels]
constexpr double kLabelWidth = 70.0;          // [pixels]
constexpr std::size_t kMostNameLetters = 40;  // of a name in the picture
const Eigen::Vector2d kGoalLabel(10.0, 4.0);  // from the goal [pixels]

Markup label(double x, double y, const std::string& text) {
  return chartText("name", x, y, core::cutText(text, kMostNameLetters));
}

std::string translated(const Eigen::Vector2d& pixel) {
  return "translate(" + svgPlace(pixel.x(), pixel.y()) + ")";
}

/// Marks and names around a pixel that keep their size when the picture is zoomed.
Markup pin(const Eigen::Vector2d& pixel, const Markup& content) {
  const Markup held = element("g", {{"class", "pin"}}, content);
  return element("g", {{"transform", translated(pixel)}}, held) + "\n";
}

/// Path data of the drivable area on the level of each elevation, each level once.
std::vector<std::string> levelsAt(const std::set<int>& elevations, const map::DrivableArea& area,
                                  const MapCanvas& canvas) {
  std::vector<std::string> levels;
  for (const int elevation : elevations) {
    std::string data;
    for (const Points& ring : area.border(elevation)) data += canvas.ring(ring);
    const bool known = std::find(levels.begin(), levels.end(), data) != levels.end();
    if (!known && !data.empty()) levels.push_back(data);
  }
  return levels;
}

/// Elevations in the picture, in whole meters: of the ego route, or of all lanes.
std::set<int> elevationsOf(const std::vector<Eigen::Vector3d>& points, const MapCanvas& canvas) {
  std::set<int> elevations;
  for (const Eigen::Vector3d& point : points) {
    if (canvas.shows(point.head<2>())) elevations.insert(static_cast<int>(std::lround(point.z())));
  }
  return elevations;
}

/// Drivable area: the levels that the ego route touches, and faintly below them the others in the
/// picture; where the picture does not show the route, all alike.
Markup drivableArea(const session::SessionSetup& setup, const MapCanvas& canvas) {
  const map::DrivableArea& area = setup.drivableArea();
  const auto& route = setup.egoRoute().path().points();
  std::vector<std::string> own = levelsAt(elevationsOf(route, canvas), area, canvas);
  std::vector<std::string> levels = own;
  if (own.empty() || area.levelCount() > 1) {
    std::set<int> elevations;
    for (const map::Lane& lane : setup.network().lanes())
      elevations.merge(elevationsOf(lane.centerline.points(), canvas));
    levels = levelsAt(elevations, area, canvas);
  }
  if (own.empty()) own = levels;
  Markup svg;
  for (const std::string& level : levels) {
    if (std::find(own.begin(), own.end(), level) == own.end()) svg += svgPath("road other", level);
  }
  for (const std::string& level : own) svg += svgPath("road", level);
  return svg;
}

Markup laneLines(const map::RoadNetwork& network, const MapCanvas& canvas) {
  std::string data;
  for (const map::Lane& lane : network.lanes()) {
    if (lane.allows_cars) data += canvas.line(inPlane(lane.centerline.points()));
  }
  return svgPath("lane", data);
}

Markup egoRoute(const session::SessionSetup& setup, const MapCanvas& canvas) {
  const auto& points = setup.egoRoute().path().points();
  if (points.empty()) return {};
  const std::string data = canvas.line(inPlane(points));
  const Eigen::Vector2d goal = canvas.toPixels(points.back().head<2>());
  return svgPath("route", data, "ego route") +
         pin(goal, element("circle", {{"class", "goal"}, {"r", "6"}}) +
                       label(kGoalLabel.x(), kGoalLabel.y(), "goal"));
}

Markup conflictRoutes(const record::SessionResult& result, const MapCanvas& canvas) {
  Markup svg;
  for (const record::CbvRecord& record : result.cbv.records()) {
    const std::string style = styleOf(VehicleRole::kCbv, record.vehicle_id, result.cbv);
    svg += svgPath("planned " + style,
                   canvas.line(inPlane({record.route.begin(), record.route.end()})),
                   "conflict-aware route of " + record.vehicle_id);
  }
  return svg;
}

/// A stretch of one vehicle's path in one role.
struct Trail {
  std::uint32_t vehicle = 0;
  VehicleRole role = VehicleRole::kBackground;
  Points points;
};

std::vector<Trail> trailsOf(const record::Timeline& timeline) {
  std::vector<Trail> trails;
  std::vector<std::ptrdiff_t> present(timeline.vehicles().size(), -1);  // trail of each vehicle
  std::vector<std::size_t> last_frame(timeline.vehicles().size(), 0);
  for (std::size_t frame = 0; frame < timeline.frames().size(); ++frame) {
    for (const record::TimelinePose& pose : timeline.frames()[frame].poses) {
      std::ptrdiff_t& trail = present[pose.vehicle];
      const bool goes_on = trail >= 0 && last_frame[pose.vehicle] + 1 == frame;
      const Trail* before = trail < 0 ? nullptr : &trails[static_cast<std::size_t>(trail)];
      if (!goes_on || before->role != pose.role) {
        Points start;
        if (goes_on) start.push_back(before->points.back());
        trail = static_cast<std::ptrdiff_t>(trails.size());
        trails.push_back({pose.vehicle, pose.role, start});
      }
      trails[static_cast<std::size_t>(trail)].points.emplace_back(pose.x, pose.y);
      last_frame[pose.vehicle] = frame;
    }
  }
  return trails;
}

Markup trailPaths(const record::SessionResult& result, const MapCanvas& canvas, VehicleRole role) {
  Markup svg;
  for (const Trail& trail : trailsOf(result.timeline)) {
    if (trail.role != role) continue;
    const std::string& id = result.timeline.vehicles()[trail.vehicle].id;
    svg += svgPath("trail " + styleOf(role, id, result.cbv), canvas.line(trail.points), id);
  }
  return svg;
}

/// A vehicle's outline with its front window, nose to the right, around the origin.
Markup vehicleShape(const record::TimelineVehicle& vehicle, double scale) {
  const double half_length = 0.5 * vehicle.length * scale;
  const double half_width = 0.5 * vehicle.width * scale;
  const std::string x = core::shortNumber(half_length);
  const std::string y = core::shortNumber(half_width);
  const std::string box = "M-" + x + " -" + y + "H" + x + "V" + y + "H-" + x + "Z";
  const std::string nose = "M" + svgPlace(0.3 * half_length, -0.8 * half_width) + "L" +
                           core::shortNumber(0.8 * half_length) + " 0L" +
                           svgPlace(0.3 * half_length, 0.8 * half_width) + "Z";
  return element("path", {{"d", box}}) + element("path", {{"class", "nose"}, {"d", nose}});
}

Markup vehicleBox(const record::TimelinePose& pose, const record::SessionResult& result,
                  const MapCanvas& canvas, const std::string& style) {
  return vehicleSvg(result.timeline.vehicles()[pose.vehicle],
                    {{pose.x, pose.y}, static_cast<double>(pose.heading)}, canvas, style,
                    vehicleMagnification(canvas));
}

Markup startBox(const record::SessionResult& result, const MapCanvas& canvas) {
  for (const record::TimelineFrame& frame : result.timeline.frames()) {
    for (const record::TimelinePose& pose : frame.poses) {
      if (pose.role != VehicleRole::kEgo) continue;
      const Eigen::Vector2d pixel = canvas.toPixels({pose.x, pose.y});
      return vehicleBox(pose, result, canvas, "start") + pin(pixel, label(10.0, -10.0, "start"));
    }
  }
  return {};
}

Markup finalBoxes(const record::SessionResult& result, const MapCanvas& canvas) {
  Markup svg = "\n";
  if (!result.timeline.frames().empty()) {
    const auto& poses = result.timeline.frames().back().poses;
    for (auto pose = poses.rbegin(); pose != poses.rend(); ++pose) {  // the ego on top
      if (!canvas.shows({pose->x, pose->y})) continue;
      const std::string& id = result.timeline.vehicles()[pose->vehicle].id;
      svg += vehicleBox(*pose, result, canvas, styleOf(pose->role, id, result.cbv));
    }
  }
  return element("g", {{"id", "vehicles"}}, svg) + "\n";
}

Markup conflictPoints(const record::SessionResult& result, const MapCanvas& canvas) {
  Markup svg;
  std::vector<Eigen::Vector2d> taken;  // places of names
  const auto& route = result.setup.egoRoute().path().points();
  if (!route.empty()) taken.push_back(canvas.toPixels(route.back().head<2>()) + kGoalLabel);
  for (const record::CbvRecord& record : result.cbv.records()) {
    const Eigen::Vector2d pixel = canvas.toPixels(record.conflict_point.position.head<2>());
    const std::string& name = record.vehicle_id;
    Eigen::Vector2d offset(10.0, -8.0);
    const auto hidden = [&](const Eigen::Vector2d& other) {
      const Eigen::Vector2d between = (other - pixel - offset).cwiseAbs();
      return between.x() < kLabelWidth && between.y() < kLabelHeight;
    };
    while (std::any_of(taken.begin(), taken.end(), hidden)) offset.y() += kLabelHeight;
    taken.push_back(pixel + offset);
    svg += pin(pixel, svgPath("conflict", "M-6 -6L6 6M6 -6L-6 6", "conflict point " + name) +
                          label(offset.x(), offset.y(), name));
  }
  return svg;
}

Markup contactMarks(const record::Timeline& timeline, const MapCanvas& canvas) {
  Markup svg;
  for (const record::TimelineContact& contact : timeline.contacts()) {
    if (!contact.position || !canvas.shows(*contact.position)) continue;
    const std::string text = "contact of " + contact.first + " and " + contact.second + " at " +
                             core::formatFixed(contact.time, 2) + " s";
    svg += pin(canvas.toPixels(*contact.position),
               element("circle", {{"class", "contact"}, {"r", "11"}}, element("title", {}, text)));
  }
  return svg;
}

}  // namespace

double vehicleMagnification(const MapCanvas& canvas) {
  constexpr double kLeastLength = 9.0;  // of a car in the picture [pixels]
  constexpr double kCarLength = 4.5;    // [m]
  constexpr double kNoticeable = 1.2;   // less than this is not worth it
  const double needed = kLeastLength / (kCarLength * canvas.scale());
  return needed > kNoticeable ? needed : 1.0;
}

std::string styleOf(VehicleRole role, const std::string& id, const record::CbvLog& cbv) {
  if (role == VehicleRole::kEgo) return "ego";
  if (role == VehicleRole::kBackground) return "bg";
  constexpr std::size_t kShades = 5;
  std::vector<std::string> seen;
  for (const record::CbvRecord& record : cbv.records()) {
    if (record.vehicle_id == id) break;
    if (std::find(seen.begin(), seen.end(), record.vehicle_id) == seen.end()) {
      seen.push_back(record.vehicle_id);
    }
  }
  return "cbv c" + std::to_string(seen.size() % kShades);
}

Markup roadSvg(const session::SessionSetup& setup, const MapCanvas& canvas) {
  return drivableArea(setup, canvas) + laneLines(setup.network(), canvas);
}

Markup vehicleSvg(const record::TimelineVehicle& vehicle, const geometry::Pose2d& pose,
                  const MapCanvas& canvas, const std::string& style, double magnification) {
  const std::string place = translated(canvas.toPixels(pose.position)) + " rotate(" +
                            core::shortNumber(-core::radiansToDegrees(pose.heading)) + ")";
  return element("g", {{"class", "vehicle " + style}, {"transform", place}},
                 element("title", {}, vehicle.id) +
                     vehicleShape(vehicle, canvas.scale() * magnification)) +
         "\n";
}

Markup scaleBarSvg(const MapCanvas& canvas) {
  const double meters = niceStep(200.0 / canvas.scale(), 2);
  const double y = canvas.height() - 18.0;
  const std::string length = core::shortNumber(meters * canvas.scale());
  const Markup bar = svgPath("scale", "M18 " + core::shortNumber(y - 5.0) + "v5h" + length + "v-5");
  const Markup north =
      svgPath("north", "M" + core::shortNumber(canvas.width() - 24.0) + " 14l6 16l-6 -4l-6 4Z");
  return element("g", {{"class", "frame"}},
                 bar + label(24.0, y - 7.0, core::formatNumber(meters) + " m") + north +
                     label(canvas.width() - 29.0, 46.0, "N")) +
         "\n";
}

namespace {

Markup pictureFromAbove(const Markup& content, const MapCanvas& canvas) {
  const double magnification = canvas.scale() * vehicleMagnification(canvas);
  return svgPicture("The session from above", {canvas.width(), canvas.height()},
                    {{"id", "top-view"},
                     {"data-magnification", core::formatFixed(magnification, 4)},
                     {"data-pixels-per-meter", core::formatFixed(canvas.scale(), 4)}},
                    content) +
         "\n";
}

}  // namespace

Markup liveTopViewSvg(const session::SessionSetup& setup, const MapCanvas& canvas) {
  Markup content = roadSvg(setup, canvas) + egoRoute(setup, canvas);
  for (const char* layer :
       {"trails", "conflicts", "vehicles", "ghosts", "plans", "contacts", "chosen", "names"})
    content += element("g", {{"id", layer}}) + "\n";
  return pictureFromAbove(content + scaleBarSvg(canvas), canvas);
}

Markup topViewSvg(const record::SessionResult& result, const MapCanvas& canvas) {
  const Markup content =
      roadSvg(result.setup, canvas) + egoRoute(result.setup, canvas) +
      conflictRoutes(result, canvas) + trailPaths(result, canvas, VehicleRole::kBackground) +
      trailPaths(result, canvas, VehicleRole::kCbv) +
      trailPaths(result, canvas, VehicleRole::kEgo) + startBox(result, canvas) +
      perceivedSvg(result.timeline, canvas) + attentionSvg(result.timeline, canvas) +
      finalBoxes(result, canvas) + element("g", {{"id", "plans"}}) +
      contactMarks(result.timeline, canvas) + conflictPoints(result, canvas) + scaleBarSvg(canvas);
  return pictureFromAbove(content, canvas);
}

namespace {

Markup boxItem(const std::string& style, const std::string& text) {
  const Markup box = element("path", {{"d", "M-10 -4H10V4H-10Z"}}) +
                     element("path", {{"class", "nose"}, {"d", "M3 -3L8 0L3 3Z"}});
  return legendItem(
      element("g", {{"class", "vehicle " + style}, {"transform", "translate(14 7)"}}, box), text);
}

/// Of what planners say about themselves.
Markup plannerLegend(const record::Timeline& timeline) {
  Markup html;
  if (showsAttention(timeline))
    html += legendLine("gaze", "attention of the planner to a vehicle, by its share");
  if (!showsPerception(timeline)) return html;
  return html + legendLine("perceived vehicle-seen", "vehicle that the planner believes to see") +
         legendLine("perceived forecast", "where it expects that vehicle in the next seconds") +
         legendLine("perceived edge-seen", "edge of the road, as it sees it") +
         legendLine("perceived divider-seen", "divider between lanes") +
         legendLine("perceived center-seen", "centerline");
}

}  // namespace

Markup topViewLegend(const MapCanvas& canvas, const record::Timeline* timeline) {
  const Markup conflict =
      element("path", {{"class", "conflict"}, {"d", "M9 2l10 10m0 -10l-10 10"}});
  const Markup html = pageLegend(
      boxItem("ego", "ego") + boxItem("cbv c0", "CBV") + boxItem("bg", "background") +
      legendLine("route", "ego route") + legendLine("trail ego", "driven by the ego") +
      legendLine("trail cbv c0", "driven as CBV") + legendLine("trail bg", "driven by background") +
      legendLine("planned cbv c0", "conflict-aware route") +
      legendLine("plan", "plan of a CBV at that moment") +
      legendItem(conflict, "conflict point as selected") +
      legendItem(svgCircle("contact", {14.0, 7.0}, 6.0), "contact") +
      (timeline == nullptr ? Markup() : plannerLegend(*timeline)));
  const double magnification = vehicleMagnification(canvas);
  if (magnification <= 1.0) return html;
  return html + pageNote("Vehicles are drawn " + core::formatFixed(magnification, 1) +
                         " times as large as they are.");
}

}  // namespace cdiff::page
