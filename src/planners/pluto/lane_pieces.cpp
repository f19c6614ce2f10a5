// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/pluto/lane_pieces.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/traffic/vehicle.h"

namespace cdiff::planners {
namespace {

constexpr double kLongestPiece = 50.0;     // [m]
constexpr double kShortestLane = 1.0;      // [m]
constexpr double kPiecePlaceScale = 10.0;  // what a center of 1 stands for [m]

void addPoint(const map::Lane& lane, double arc_length, double next, std::size_t i,
              LanePiece& piece) {
  const geometry::Polyline& line = lane.centerline;
  const Eigen::Vector2d center = line.positionAt(arc_length);
  const Eigen::Vector2d forward =
      geometry::direction(line.headingAt(arc_length) - piece.pose.heading);
  const Eigen::Vector2d place = piece.pose.toBody(center);
  const Eigen::Vector2d step = piece.pose.toBody(line.positionAt(next)) - place;
  const Eigen::Vector2d left = 0.5 * lane.width * geometry::leftNormal(forward);
  piece.centers[i] = center;
  piece.reach = std::max(piece.reach, place.norm());
  const std::array<double, kPieceChannels> values = {place.x() / kPiecePlaceScale,
                                                     place.y() / kPiecePlaceScale,
                                                     step.x(),
                                                     step.y(),
                                                     forward.x(),
                                                     forward.y(),
                                                     left.x(),
                                                     left.y(),
                                                     -left.x(),
                                                     -left.y()};
  for (std::size_t c = 0; c < values.size(); ++c)
    piece.points[i * values.size() + c] = static_cast<float>(values[c]);
}

LanePiece pieceOf(const map::Lane& lane, double begin, double end) {
  const geometry::Polyline& line = lane.centerline;
  const double middle = 0.5 * (begin + end);
  LanePiece piece;
  piece.pose = {line.positionAt(middle), line.headingAt(middle)};
  piece.elevation = line.pointAt(middle).z();
  const double spacing = (end - begin) / static_cast<double>(kPiecePoints - 1);
  for (std::size_t i = 0; i < static_cast<std::size_t>(kPiecePoints); ++i) {
    const double arc_length = begin + spacing * static_cast<double>(i);
    addPoint(lane, arc_length, std::min(arc_length + spacing, end), i, piece);
  }
  return piece;
}

double distanceTo(const LanePiece& piece, const Eigen::Vector2d& position) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector2d& center : piece.centers)
    nearest = std::min(nearest, (center - position).norm());
  return nearest;
}

}  // namespace

LanePieces::LanePieces(const map::RoadNetwork& network) {
  std::map<map::LaneIndex, std::pair<std::string, int>> lights;  // by the lane that they lead to
  for (const map::Lane& lane : network.lanes()) {
    for (const map::LaneLink& link : lane.next) {
      if (!link.signal_id.empty()) lights[link.to] = {link.signal_id, link.signal_link};
    }
  }
  for (std::size_t i = 0; i < network.lanes().size(); ++i) {
    const map::Lane& lane = network.lanes()[i];
    const double length = lane.centerline.length();
    if (!lane.allows_cars || length < kShortestLane) continue;
    const double parts = std::ceil(length / kLongestPiece);
    for (double part = 0.0; part < parts; part += 1.0) {
      pieces_.push_back(pieceOf(lane, length * part / parts, length * (part + 1.0) / parts));
      pieces_.back().lane = static_cast<map::LaneIndex>(i);
      const auto light = lights.find(pieces_.back().lane);
      if (light == lights.end()) continue;
      pieces_.back().signal = light->second.first;
      pieces_.back().link = light->second.second;
    }
  }
}

std::vector<std::uint32_t> LanePieces::near(const Eigen::Vector2d& position, double elevation,
                                            double radius, std::size_t most) const {
  std::vector<std::pair<double, std::uint32_t>> found;
  for (std::size_t i = 0; i < pieces_.size(); ++i) {
    const LanePiece& piece = pieces_[i];
    if (traffic::onDifferentLevels(piece.elevation, elevation)) continue;
    if ((piece.pose.position - position).norm() > radius + piece.reach) continue;
    const double distance = distanceTo(piece, position);
    if (distance <= radius) found.emplace_back(distance, static_cast<std::uint32_t>(i));
  }
  const auto kept = static_cast<std::ptrdiff_t>(std::min(most, found.size()));
  std::partial_sort(found.begin(), found.begin() + kept, found.end());
  std::vector<std::uint32_t> numbers;
  for (std::ptrdiff_t i = 0; i < kept; ++i)
    numbers.push_back(found[static_cast<std::size_t>(i)].second);
  return numbers;
}

}  // namespace cdiff::planners
