// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "map/border_index.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <numeric>
#include <polyclipping/clipper.hpp>

#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::map {
namespace {

constexpr double kClosingRadius = 0.15;  // [m] half the widest slit that is closed
constexpr double kLeastHoleArea = 1.0;   // [m^2]
constexpr double kMitreLimit = 2.0;      // longest mitre in strip half-widths

ClipperLib::Path toGrid(const std::vector<Eigen::Vector2d>& points) {
  ClipperLib::Path path;
  path.reserve(points.size());
  for (const Eigen::Vector2d& point : points) {
    path.emplace_back(std::llround(point.x() * kUnitsPerMeter),
                      std::llround(point.y() * kUnitsPerMeter));
  }
  return path;
}

ClipperLib::Paths stripOutline(const Strip& strip) {
  ClipperLib::ClipperOffset offset(kMitreLimit);
  offset.AddPath(toGrid(strip.line), ClipperLib::jtMiter, ClipperLib::etOpenButt);
  ClipperLib::Paths outline;
  offset.Execute(outline, 0.5 * strip.width * kUnitsPerMeter);
  return outline;
}

/// A polygon that may cross itself or run either way round, as simple rings.
ClipperLib::Paths polygonOutline(const Ring& polygon) {
  ClipperLib::Paths outline;
  ClipperLib::SimplifyPolygon(toGrid(polygon), outline, ClipperLib::pftNonZero);
  return outline;
}

ClipperLib::Paths grown(const ClipperLib::Paths& paths, double distance) {
  ClipperLib::ClipperOffset offset(kMitreLimit);
  offset.AddPaths(paths, ClipperLib::jtMiter, ClipperLib::etClosedPolygon);
  ClipperLib::Paths result;
  offset.Execute(result, distance * kUnitsPerMeter);
  return result;
}

std::vector<Ring> toRings(const ClipperLib::Paths& paths) {
  constexpr double kLeastHole = kLeastHoleArea * kUnitsPerMeter * kUnitsPerMeter;
  std::vector<Ring> rings;
  for (const ClipperLib::Path& path : paths) {
    const double area = ClipperLib::Area(path);  // negative for holes
    if (path.size() < 3 || (area <= 0.0 && area > -kLeastHole)) continue;
    Ring ring;
    ring.reserve(path.size());
    for (const ClipperLib::IntPoint& point : path) {
      ring.emplace_back(static_cast<double>(point.X) / kUnitsPerMeter,
                        static_cast<double>(point.Y) / kUnitsPerMeter);
    }
    rings.push_back(std::move(ring));
  }
  return rings;
}

}  // namespace

std::vector<Ring> uniteOutlines(const std::vector<Strip>& strips,
                                const std::vector<Ring>& polygons) {
  ClipperLib::Clipper clipper;
  for (const Strip& strip : strips)
    clipper.AddPaths(stripOutline(strip), ClipperLib::ptSubject, true);
  for (const Ring& polygon : polygons) {
    clipper.AddPaths(polygonOutline(polygon), ClipperLib::ptSubject, true);
  }
  ClipperLib::Paths united;
  clipper.Execute(ClipperLib::ctUnion, united, ClipperLib::pftNonZero, ClipperLib::pftNonZero);
  return toRings(grown(grown(united, kClosingRadius), -kClosingRadius));
}

namespace {

constexpr double kMargin = 64.0;    // [m] of indexed ground around the border
constexpr double kLeastCell = 2.0;  // [m]
constexpr double kFarCellShare =
    0.25;                       // cells need not be smaller than this share of their distance
constexpr double kTile = 64.0;  // [m] squares of this size are split when asked for
constexpr std::size_t kFewSegments = 4;  // such a list is not worth splitting
constexpr double kTieTolerance = 1e-10;  // relative, of squared distances

}  // namespace

/// Quadtree over a square. Node 0 is the square itself.
struct BorderIndex::Tree {
  /// Square cell with four children from `first_child` on, or else a tile, or else a leaf, whose
  /// segments are candidates[begin, end).
  struct Node {
    std::uint32_t first_child = 0;  ///< 0: none
    std::uint32_t tile = 0;         ///< its number from 1 on; 0: none
    std::uint32_t begin = 0;
    std::uint32_t end = 0;
  };

  Tree() : nodes(1) {}
  ~Tree();

  std::vector<Node> nodes;
  std::vector<SegmentIndex> candidates;
  std::vector<std::unique_ptr<Tile>> tiles;
};

/// A square that is split when a query first comes to it.
struct BorderIndex::Tile {
  Square square;
  std::vector<SegmentIndex> segments;  ///< that can be nearest to its points
  std::once_flag made;
  Tree tree;
};

BorderIndex::Tree::~Tree() = default;
BorderIndex::~BorderIndex() = default;

/// Nearest segment so far. Where the nearest point is a vertex, its segments tie; the one that the
/// point lies farthest beside is the one that bounds the point's sector around the vertex, so its
/// side distinguishes inside from outside.
struct BorderIndex::Nearest {
  const Segment* segment = nullptr;
  double squared = std::numeric_limits<double>::infinity();
  double across = 0.0;  ///< signed distance to the segment's line, positive left
};

BorderIndex::Square BorderIndex::Square::child(int quadrant) const {
  const double quarter = 0.5 * half;
  const Eigen::Vector2d offset((quadrant & 1) ? quarter : -quarter,
                               (quadrant & 2) ? quarter : -quarter);
  return {center + offset, quarter};
}

BorderIndex::BorderIndex(const std::vector<Ring>& rings) {
  for (const Ring& ring : rings) addSegments(ring);
  if (segments_.empty()) throw core::InputError("the drivable area has no border: it is empty");
  Eigen::Vector2d low = segments_.front().begin;
  Eigen::Vector2d high = low;
  for (const Segment& segment : segments_) {
    low = low.cwiseMin(segment.begin);
    high = high.cwiseMax(segment.begin);
  }
  root_.center = 0.5 * (low + high);
  root_.half = 0.5 * kLeastCell;
  while (root_.half < 0.5 * (high - low).maxCoeff() + kMargin) root_.half *= 2.0;
  std::vector<SegmentIndex> all(segments_.size());
  std::iota(all.begin(), all.end(), SegmentIndex{0});
  tree_ = std::make_unique<Tree>();
  build(*tree_, 0, root_, all, kTile);
}

void BorderIndex::addSegments(const Ring& ring) {
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Eigen::Vector2d& begin = ring[i];
    const Eigen::Vector2d& end = ring[(i + 1) % ring.size()];
    const double length = (end - begin).norm();
    if (length > 0.0) segments_.push_back({begin, end, (end - begin) / length, length});
  }
}

double BorderIndex::distance(const Segment& segment, const Eigen::Vector2d& point) {
  const double along = std::clamp(segment.along.dot(point - segment.begin), 0.0, segment.length);
  return (segment.begin + along * segment.along - point).norm();
}

bool BorderIndex::keepNear(const Square& square, const std::vector<SegmentIndex>& from_parent,
                           std::vector<SegmentIndex>& kept) const {
  std::vector<double> distances(from_parent.size());
  for (std::size_t i = 0; i < from_parent.size(); ++i) {
    distances[i] = distance(segments_[from_parent[i]], square.center);
  }
  // A segment nearest to a point at most r from the center is at most least + 2 r from the center.
  const double least = *std::min_element(distances.begin(), distances.end());
  const double limit = least + 2.0 * std::sqrt(2.0) * square.half + 1e-6;
  for (std::size_t i = 0; i < from_parent.size(); ++i) {
    if (distances[i] <= limit) kept.push_back(from_parent[i]);
  }
  const double size = 2.0 * square.half;
  return kept.size() > kFewSegments && size > kLeastCell && size > kFarCellShare * least;
}

void BorderIndex::build(Tree& tree, std::uint32_t node, const Square& square,
                        const std::vector<SegmentIndex>& from_parent, double largest_tile) const {
  std::vector<SegmentIndex> kept;
  if (!keepNear(square, from_parent, kept)) {
    tree.nodes[node].begin = static_cast<std::uint32_t>(tree.candidates.size());
    tree.candidates.insert(tree.candidates.end(), kept.begin(), kept.end());
    tree.nodes[node].end = static_cast<std::uint32_t>(tree.candidates.size());
    return;
  }
  if (2.0 * square.half <= largest_tile) {
    tree.tiles.push_back(std::make_unique<Tile>());
    tree.tiles.back()->square = square;
    tree.tiles.back()->segments = std::move(kept);
    tree.nodes[node].tile = static_cast<std::uint32_t>(tree.tiles.size());
    return;
  }
  const auto first_child = static_cast<std::uint32_t>(tree.nodes.size());
  tree.nodes[node].first_child = first_child;
  tree.nodes.resize(tree.nodes.size() + 4);
  for (int quadrant = 0; quadrant < 4; ++quadrant) {
    build(tree, first_child + static_cast<std::uint32_t>(quadrant), square.child(quadrant), kept,
          largest_tile);
  }
}

const BorderIndex::Tree& BorderIndex::treeOf(Tile& tile) const {
  std::call_once(tile.made, [&] { build(tile.tree, 0, tile.square, tile.segments, 0.0); });
  return tile.tree;
}

void BorderIndex::examine(const Segment& segment, const Eigen::Vector2d& point,
                          Nearest& nearest) const {
  const Eigen::Vector2d from_begin = point - segment.begin;
  const double along = segment.along.dot(from_begin);
  const double across = geometry::cross(segment.along, from_begin);
  const double squared = along <= 0.0              ? from_begin.squaredNorm()
                         : along >= segment.length ? (point - segment.end).squaredNorm()
                                                   : across * across;
  if (squared > nearest.squared * (1.0 + kTieTolerance)) return;
  const bool tie = squared >= nearest.squared * (1.0 - kTieTolerance);
  if (tie && std::abs(across) <= std::abs(nearest.across)) return;
  nearest = {&segment, squared, across};
}

BorderIndex::Nearest BorderIndex::nearest(const Eigen::Vector2d& point) const {
  Nearest nearest;
  if (!((point - root_.center).cwiseAbs().maxCoeff() <= root_.half)) {
    for (const Segment& segment : segments_) examine(segment, point, nearest);
    return nearest;
  }
  const Tree* tree = tree_.get();
  const Tree::Node* node = &tree->nodes.front();
  double x = root_.center.x();
  double y = root_.center.y();
  double half = root_.half;
  while (node->first_child != 0 || node->tile != 0) {
    if (node->tile != 0) {
      tree = &treeOf(*tree->tiles[node->tile - 1]);
      node = &tree->nodes.front();
      continue;
    }
    const bool right = point.x() >= x;
    const bool upper = point.y() >= y;
    half *= 0.5;
    x += right ? half : -half;
    y += upper ? half : -half;
    node = &tree->nodes[node->first_child + (right ? 1u : 0u) + (upper ? 2u : 0u)];
  }
  for (std::uint32_t i = node->begin; i < node->end; ++i) {
    examine(segments_[tree->candidates[i]], point, nearest);
  }
  return nearest;
}

SignedDistance BorderIndex::query(const Eigen::Vector2d& point) const {
  constexpr double kOnBorder = 1e-9;
  if (!point.allFinite())
    throw core::InputError("distance to the border asked for a non-finite position");
  const Nearest found = nearest(point);
  const Segment& segment = *found.segment;
  const double length = std::sqrt(found.squared);
  const double sign = found.across < 0.0 ? -1.0 : 1.0;
  if (length < kOnBorder) return {sign * length, geometry::leftNormal(segment.along)};
  const double along = std::clamp(segment.along.dot(point - segment.begin), 0.0, segment.length);
  const Eigen::Vector2d foot = segment.begin + along * segment.along;
  return {sign * length, sign * (point - foot).normalized()};
}

}  // namespace cdiff::map
