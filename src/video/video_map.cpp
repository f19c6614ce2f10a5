// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "video/video_map.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "video/video_highlights.h"

namespace cdiff::video {
namespace {

using traffic::VehicleRole;

constexpr double kWidth = 120.0;     // of what is shown [m]
constexpr double kTrailTime = 20.0;  // [s]
constexpr int kShift = 4;            // sub-pixel bits of OpenCV's drawing

cv::Point subPixel(const Eigen::Vector2d& pixel) {
  constexpr double kParts = 1 << kShift;
  return {static_cast<int>(std::lround(kParts * pixel.x())),
          static_cast<int>(std::lround(kParts * pixel.y()))};
}

cv::Point wholePixel(const Eigen::Vector2d& pixel) {
  return {static_cast<int>(std::lround(pixel.x())), static_cast<int>(std::lround(pixel.y()))};
}

std::vector<cv::Point> subPixels(const page::Points& points, const page::MapCanvas& canvas) {
  std::vector<cv::Point> pixels;
  for (const Eigen::Vector2d& point : points) pixels.push_back(subPixel(canvas.toPixels(point)));
  return pixels;
}

/// The parts of lines that lie in the picture.
void drawLine(cv::Mat picture, const page::MapCanvas& canvas, const page::Points& line,
              const cv::Scalar& color, int thickness) {
  constexpr double kOverhang = 5.0;  // [m]
  for (const page::Points& stretch : page::stretchesIn(line, canvas.region().grown(kOverhang))) {
    cv::polylines(picture, subPixels(stretch, canvas), false, color, thickness, cv::LINE_AA,
                  kShift);
  }
}

page::MapCanvas canvasAround(const Eigen::Vector2d& center, const cv::Size& size) {
  const Eigen::Vector2d pixels(size.width, size.height);
  const Eigen::Vector2d half = 0.5 * kWidth / pixels.x() * pixels;
  return {{center - half, center + half}, pixels};
}

/// Corners of a part of the box: along and across it, in shares of its half length and width.
std::vector<cv::Point> outline(const traffic::Vehicle& vehicle, const page::MapCanvas& canvas,
                               const std::vector<Eigen::Vector2d>& shares) {
  const Eigen::Vector2d ahead = geometry::direction(vehicle.state.heading);
  const Eigen::Vector2d left(-ahead.y(), ahead.x());
  std::vector<cv::Point> pixels;
  for (const Eigen::Vector2d& share : shares) {
    const Eigen::Vector2d point = vehicle.state.position +
                                  0.5 * vehicle.dimensions.length * share.x() * ahead +
                                  0.5 * vehicle.dimensions.width * share.y() * left;
    pixels.push_back(subPixel(canvas.toPixels(point)));
  }
  return pixels;
}

/// A ring around the place and a plate with the names below it.
void drawContact(cv::Mat picture, const page::MapCanvas& canvas, const ContactMark& contact) {
  if (!canvas.shows(contact.position)) return;
  const cv::Scalar color = inkOf(contact);
  const Eigen::Vector2d pixel = canvas.toPixels(contact.position);
  cv::circle(picture, subPixel(pixel), 26 << kShift, ink::kPage, 7, cv::LINE_AA, kShift);
  cv::circle(picture, subPixel(pixel), 26 << kShift, color, 4, cv::LINE_AA, kShift);
  const std::string text = cutText(contact.label, picture.cols - 40, 0.5);
  const int width = textWidth(text, 0.5) + 16;
  const cv::Point at = wholePixel(pixel);
  const int left = std::clamp(at.x - width / 2, 4, std::max(4, picture.cols - width - 4));
  const int top = std::clamp(at.y + 36, 4, picture.rows - 30);
  cv::rectangle(picture, cv::Rect(left, top, width, 24), color, cv::FILLED);
  writeText(picture, text, {left + 8, top + 17}, 0.5, ink::kPage);
}

}  // namespace

VideoMap::VideoMap(const session::SessionSetup& setup, const cv::Size& size)
    : setup_(setup), size_(size) {
  for (const map::Lane& lane : setup.network().lanes()) {
    if (lane.allows_cars) lanes_.push_back(page::inPlane(lane.centerline.points()));
  }
}

void VideoMap::observe(const session::TickRecord& record) {
  snapshot_ = *record.snapshot;
  if (record.selection != nullptr) assignments_ = record.selection->assignments;
  const traffic::Vehicle* ego = snapshot_.ego();
  if (ego != nullptr && isPlaced(*ego)) {
    center_ = ego->state.position;
    elevation_ = ego->state.elevation;
  }
  for (const traffic::Vehicle& vehicle : snapshot_.vehicles) {
    const bool driven = vehicle.role != VehicleRole::kBackground;
    if (driven && isPlaced(vehicle)) {
      trails_[vehicle.id].emplace_back(snapshot_.time, vehicle.state.position);
    }
  }
  for (auto& [id, trail] : trails_) {
    while (!trail.empty() && trail.front().first < snapshot_.time - kTrailTime) trail.pop_front();
  }
}

void VideoMap::draw(cv::Mat picture, const std::deque<ContactMark>& contacts) const {
  const page::MapCanvas canvas = canvasAround(center_, size_);
  picture.setTo(ink::kGround);
  drawRoad(picture, canvas);
  drawRoute(picture, canvas);
  drawTrails(picture, canvas);
  for (auto vehicle = snapshot_.vehicles.rbegin(); vehicle != snapshot_.vehicles.rend();
       ++vehicle) {  // the ego on top
    if (isPlaced(*vehicle) && canvas.shows(vehicle->state.position)) {
      drawVehicle(picture, canvas, *vehicle);
    }
  }
  drawConflicts(picture, canvas);
  for (const ContactMark& contact : contacts) drawContact(picture, canvas, contact);
  drawScale(picture, canvas);
}

const std::vector<page::Points>& VideoMap::ringsAt(double elevation) const {
  const int level = static_cast<int>(std::lround(elevation));
  const auto known = rings_.find(level);
  if (known != rings_.end()) return known->second;
  return rings_[level] = setup_.drivableArea().border(level);
}

void VideoMap::drawRoad(cv::Mat picture, const page::MapCanvas& canvas) const {
  constexpr double kOverhang = 5.0;  // [m]
  Polygons polygons;
  for (const page::Points& ring : ringsAt(elevation_)) {
    const page::Points inside = page::clippedRing(ring, canvas.region().grown(kOverhang));
    if (inside.size() > 2) polygons.push_back(subPixels(inside, canvas));
  }
  cv::fillPoly(picture, polygons, ink::kRoad, cv::LINE_AA, kShift);
  cv::polylines(picture, polygons, true, ink::kEdge, 1, cv::LINE_AA, kShift);
  for (const page::Points& lane : lanes_) drawLine(picture, canvas, lane, ink::kEdge, 1);
}

void VideoMap::drawRoute(cv::Mat picture, const page::MapCanvas& canvas) const {
  drawLine(picture, canvas, page::inPlane(setup_.egoRoute().path().points()), ink::kRoute, 7);
}

void VideoMap::drawTrails(cv::Mat picture, const page::MapCanvas& canvas) const {
  for (const auto& [id, trail] : trails_) {
    const traffic::Vehicle* vehicle = snapshot_.find(id);
    if (vehicle == nullptr) continue;
    page::Points points;
    for (const auto& [time, position] : trail) points.push_back(position);
    drawLine(picture, canvas, points, inkOf(vehicle->role, vehicle->cbv_slot), 2);
  }
}

void VideoMap::drawVehicle(cv::Mat picture, const page::MapCanvas& canvas,
                           const traffic::Vehicle& vehicle) const {
  const auto box = outline(vehicle, canvas, {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}});
  const cv::Scalar color = inkOf(vehicle.role, vehicle.cbv_slot);
  if (std::abs(vehicle.state.elevation - elevation_) > 2.5) {  // on another level
    cv::polylines(picture, box, true, color, 1, cv::LINE_AA, kShift);
    return;
  }
  cv::fillConvexPoly(picture, box, color, cv::LINE_AA, kShift);
  cv::polylines(picture, box, true, ink::kPage, 1, cv::LINE_AA, kShift);
  cv::fillConvexPoly(picture, outline(vehicle, canvas, {{0.4, -0.7}, {0.85, 0}, {0.4, 0.7}}),
                     ink::kPage, cv::LINE_AA, kShift);
  if (vehicle.role != VehicleRole::kCbv) return;
  const cv::Point at = wholePixel(canvas.toPixels(vehicle.state.position));
  writeText(picture, vehicle.id, at + cv::Point(12, -10), 0.45, ink::kPage, true);
  writeText(picture, vehicle.id, at + cv::Point(12, -10), 0.45, color);
}

void VideoMap::drawConflicts(cv::Mat picture, const page::MapCanvas& canvas) const {
  for (const cbv::CbvAssignment& assignment : assignments_) {
    const Eigen::Vector2d position = assignment.conflict_point.position.head<2>();
    if (!canvas.shows(position)) continue;
    cv::drawMarker(picture, wholePixel(canvas.toPixels(position)), ink::kText,
                   cv::MARKER_TILTED_CROSS, 14, 2, cv::LINE_AA);
  }
}

void VideoMap::drawScale(cv::Mat picture, const page::MapCanvas& canvas) const {
  constexpr double kMeters = 20.0;
  const cv::Point left(16, size_.height - 16);
  const cv::Point right(left.x + static_cast<int>(std::lround(kMeters * canvas.scale())), left.y);
  cv::line(picture, left, right, ink::kText, 2, cv::LINE_AA);
  writeText(picture, "20 m", left + cv::Point(0, -8), 0.45, ink::kText);
  const cv::Point top(size_.width - 20, 14);
  cv::arrowedLine(picture, top + cv::Point(0, 24), top, ink::kText, 2, cv::LINE_AA, 0, 0.35);
  writeText(picture, "N", top + cv::Point(-5, 42), 0.45, ink::kText);
}

}  // namespace cdiff::video
