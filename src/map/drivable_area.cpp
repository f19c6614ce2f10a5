// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/map/drivable_area.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <set>

#include "e2e_cdiff/core/exceptions.h"
#include "map/border_cache.h"

namespace cdiff::map {
namespace {

constexpr double kLevelSpacing = 2.0;  // [m]
constexpr double kLevelReach = 3.0;  // [m] a level holds what is at most this far above or below it
constexpr double kPieceLength = 10.0;  // [m]

/// Part of a lane, or a whole junction, that belongs to a level or does not.
struct Piece {
  int lane = -1;       ///< -1 for a junction
  int junction = -1;   ///< -1 for a lane
  double begin = 0.0;  ///< arc length on the lane [m]
  double end = 0.0;
  double lowest = 0.0;   ///< elevation [m]
  double highest = 0.0;  ///< the same as `lowest` for a lane: its mean

  bool inReachOf(double height) const {
    return lowest <= height + kLevelReach && highest >= height - kLevelReach;
  }
};

void addLanePieces(const RoadNetwork& network, int index, std::vector<Piece>& pieces) {
  const geometry::Polyline& line = network.lane(index).centerline;
  const int count = std::max(1, static_cast<int>(std::ceil(line.length() / kPieceLength)));
  const double length = line.length() / count;
  for (int i = 0; i < count; ++i) {
    Piece piece;
    piece.lane = index;
    piece.begin = i * length;
    piece.end = i + 1 == count ? line.length() : (i + 1) * length;
    piece.lowest = 0.5 * (line.pointAt(piece.begin).z() + line.pointAt(piece.end).z());
    piece.highest = piece.lowest;
    pieces.push_back(piece);
  }
}

std::vector<Piece> cutNetwork(const RoadNetwork& network) {
  std::vector<Piece> pieces;
  std::set<std::string> used_junctions;
  for (int i = 0; i < static_cast<int>(network.lanes().size()); ++i) {
    if (!network.lane(i).allows_cars) continue;
    addLanePieces(network, i, pieces);
    used_junctions.insert(network.lane(i).junction_id);
  }
  for (std::size_t i = 0; i < network.junctions().size(); ++i) {
    const Junction& junction = network.junctions()[i];
    if (junction.shape.size() < 3 || used_junctions.count(junction.id) == 0) continue;
    Piece piece;
    piece.junction = static_cast<int>(i);
    const auto [low, high] = std::minmax_element(
        junction.shape.begin(), junction.shape.end(),
        [](const auto& left, const auto& right) { return left.z() < right.z(); });
    piece.lowest = low->z();
    piece.highest = high->z();
    pieces.push_back(piece);
  }
  return pieces;
}

std::vector<double> levelHeights(const std::vector<Piece>& pieces) {
  double low = pieces.front().lowest;
  double high = pieces.front().highest;
  for (const Piece& piece : pieces) {
    low = std::min(low, piece.lowest);
    high = std::max(high, piece.highest);
  }
  if (high - low <= kLevelSpacing) return {0.5 * (low + high)};
  std::vector<double> heights;
  const double last = std::round(high / kLevelSpacing);
  for (double step = std::round(low / kLevelSpacing); step <= last; step += 1.0) {
    heights.push_back(step * kLevelSpacing);
  }
  return heights;
}

Strip lanePart(const Lane& lane, double begin, double end) {
  Strip strip;
  strip.width = lane.width;
  const geometry::Polyline part = lane.centerline.slice(begin, end);
  for (const Eigen::Vector3d& point : part.points()) strip.line.push_back(point.head<2>());
  return strip;
}

/// What the area of a level is the union of.
struct Outlines {
  std::vector<Strip> strips;
  std::vector<Ring> polygons;
};

/// Of the chosen pieces; neighboring pieces of a lane form one strip.
Outlines outlinesOf(const RoadNetwork& network, const std::vector<Piece>& pieces,
                    const std::vector<bool>& chosen) {
  Outlines outlines;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    if (!chosen[i]) continue;
    if (pieces[i].lane < 0) {
      Ring ring;
      const auto& shape = network.junctions()[static_cast<std::size_t>(pieces[i].junction)].shape;
      for (const Eigen::Vector3d& point : shape) ring.push_back(point.head<2>());
      outlines.polygons.push_back(std::move(ring));
      continue;
    }
    const std::size_t first = i;
    while (i + 1 < pieces.size() && chosen[i + 1] && pieces[i + 1].lane == pieces[first].lane) ++i;
    outlines.strips.push_back(
        lanePart(network.lane(pieces[first].lane), pieces[first].begin, pieces[i].end));
  }
  return outlines;
}

}  // namespace

/// The area between two heights (equal unless neighboring heights hold the same pieces). Its border
/// is made when it is first asked for: a session seldom comes to all levels of a town.
struct DrivableArea::Level {
  struct Border {
    explicit Border(std::vector<Ring> all) : rings(std::move(all)), index(rings) {}
    std::vector<Ring> rings;
    BorderIndex index;
  };

  Level(double height, Outlines outlines)
      : lowest(height),
        highest(height),
        strips(std::move(outlines.strips)),
        polygons(std::move(outlines.polygons)) {}
  /// From any thread.
  const Border& border() const {
    std::call_once(made,
                   [this] { made_border = std::make_unique<Border>(keptUnion(strips, polygons)); });
    return *made_border;
  }

  double lowest;              ///< [m]
  double highest;             ///< [m]
  std::vector<Strip> strips;  ///< the area is their union with the polygons
  std::vector<Ring> polygons;
  mutable std::once_flag made;
  mutable std::unique_ptr<const Border> made_border;
};

DrivableArea::DrivableArea(const RoadNetwork& network) {
  const std::vector<Piece> pieces = cutNetwork(network);
  if (pieces.empty())
    throw core::InputError("the network has no lane that allows cars: no drivable area");
  std::vector<bool> previous;
  for (const double height : levelHeights(pieces)) {
    std::vector<bool> chosen;
    for (const Piece& piece : pieces) chosen.push_back(piece.inReachOf(height));
    if (std::find(chosen.begin(), chosen.end(), true) == chosen.end()) continue;
    if (chosen == previous) {
      levels_.back()->highest = height;
      continue;
    }
    levels_.push_back(std::make_unique<Level>(height, outlinesOf(network, pieces, chosen)));
    previous = std::move(chosen);
  }
}

DrivableArea::DrivableArea(DrivableArea&&) noexcept = default;
DrivableArea& DrivableArea::operator=(DrivableArea&&) noexcept = default;
DrivableArea::~DrivableArea() = default;

const DrivableArea::Level& DrivableArea::levelAt(double elevation) const {
  // Levels rise: the first that is not followed by a nearer one.
  std::size_t best = 0;
  while (best + 1 < levels_.size() &&
         levels_[best + 1]->lowest - elevation < elevation - levels_[best]->highest) {
    ++best;
  }
  return *levels_[best];
}

SignedDistance DrivableArea::signedDistanceWithGradient(const Eigen::Vector2d& position,
                                                        double elevation) const {
  return levelAt(elevation).border().index.query(position);
}

double DrivableArea::signedDistance(const Eigen::Vector2d& position, double elevation) const {
  return signedDistanceWithGradient(position, elevation).distance;
}

double DrivableArea::signedDistance(const geometry::OrientedBox& box, double elevation) const {
  double least = std::numeric_limits<double>::infinity();
  if (!box.center.allFinite() || !std::isfinite(box.heading)) return -least;  // nowhere
  for (const Eigen::Vector2d& corner : box.corners())
    least = std::min(least, signedDistance(corner, elevation));
  return least;
}

bool DrivableArea::contains(const Eigen::Vector2d& position, double elevation) const {
  return signedDistance(position, elevation) >= 0.0;
}

std::vector<std::vector<Eigen::Vector2d>> DrivableArea::border(double elevation) const {
  return levelAt(elevation).border().rings;
}

std::size_t DrivableArea::levelCount() const { return levels_.size(); }

}  // namespace cdiff::map
