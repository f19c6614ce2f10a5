// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "map/route_builder.h"

#include <algorithm>
#include <cmath>

#include "e2e_cdiff/core/exceptions.h"
#include "map/lane_search.h"

namespace cdiff::map {
namespace {

constexpr double kBlendLength = 25.0;        // [m] of a comfortable lane change
constexpr double kSampleSpacing = 0.25;      // [m] before resampling
constexpr std::size_t kRoundingSamples = 6;  // samples to each side of a corner that round it
constexpr double kPointSpacing = 1.0;        // [m] of the finished route
constexpr double kSamePoint = 1e-3;          // [m]

/// Connected lanes without a change, prolonged at both ends along lanes that run beside the rest of
/// the route.
struct Run {
  std::vector<Eigen::Vector3d> points;
  std::vector<std::pair<double, LaneIndex>> lane_starts;  ///< arc length where each lane starts
  geometry::Polyline line;
  double in = 0.0;   ///< arc length at which the run is entered
  double out = 0.0;  ///< arc length at which the run is left

  /// Adds a part of a lane and returns the arc length at which it starts.
  double append(const RoadNetwork& network, const LaneStretch& stretch);
  LaneIndex laneAt(double arc_length) const;

 private:
  void addPoint(const Eigen::Vector3d& point);
  double length_ = 0.0;
};

void Run::addPoint(const Eigen::Vector3d& point) {
  const double step = points.empty() ? 0.0 : (point - points.back()).head<2>().norm();
  if (!points.empty() && step < kSamePoint) return;
  length_ += step;
  points.push_back(point);
}

double Run::append(const RoadNetwork& network, const LaneStretch& stretch) {
  const geometry::Polyline& lane = network.lane(stretch.lane).centerline;
  addPoint(lane.pointAt(stretch.begin));
  const double begin = length_;
  lane_starts.emplace_back(begin, stretch.lane);
  for (std::size_t i = 0; i < lane.points().size(); ++i) {
    const double arc_length = lane.arcLengths()[i];
    if (arc_length > stretch.begin && arc_length < stretch.end) addPoint(lane.points()[i]);
  }
  addPoint(lane.pointAt(stretch.end));
  return begin;
}

LaneIndex Run::laneAt(double arc_length) const {
  LaneIndex found = lane_starts.front().second;
  for (const auto& [begin, lane] : lane_starts) {
    if (begin <= arc_length) found = lane;
  }
  return found;
}

/// Builds the runs of a drive and blends them into one line.
class RouteBuilder {
 public:
  RouteBuilder(const RoadNetwork& network, const std::vector<LaneStretch>& drive)
      : network_(network), drive_(drive) {}
  Route build();

 private:
  struct Window {
    double begin = 0.0;  ///< relative to the change [m]
    double length = 0.0;
  };
  void splitIntoRuns();
  Run makeRun(std::size_t first, std::size_t last) const;
  std::vector<LaneStretch> lanesBefore(std::size_t first) const;
  std::vector<LaneStretch> lanesAfter(std::size_t last) const;
  Window windowAt(std::size_t change) const;
  void sampleRun(const Run& run, double begin, double end);
  void sampleBlend(const Run& from, const Run& to, const Window& window);
  void addSample(const Eigen::Vector3d& point, LaneIndex lane);
  void dropOverlaps();
  std::size_t passedAgain(std::size_t last, const Eigen::Vector2d& along) const;
  Route resample() const;

  const RoadNetwork& network_;
  const std::vector<LaneStretch>& drive_;
  std::vector<Run> runs_;
  std::vector<Eigen::Vector3d> points_;
  std::vector<LaneIndex> lanes_;
};

Route RouteBuilder::build() {
  splitIntoRuns();
  double cursor = 0.0;
  for (std::size_t i = 0; i + 1 < runs_.size(); ++i) {
    const Window window = windowAt(i);
    sampleRun(runs_[i], cursor, runs_[i].out + window.begin);
    sampleBlend(runs_[i], runs_[i + 1], window);
    cursor = runs_[i + 1].in + window.begin + window.length;
  }
  sampleRun(runs_.back(), cursor, runs_.back().out);
  dropOverlaps();
  return resample();
}

void RouteBuilder::splitIntoRuns() {
  std::size_t first = 0;
  for (std::size_t i = 1; i <= drive_.size(); ++i) {
    if (i < drive_.size() && follows(network_, drive_[i - 1].lane, drive_[i].lane)) continue;
    runs_.push_back(makeRun(first, i - 1));
    first = i;
  }
}

Run RouteBuilder::makeRun(std::size_t first, std::size_t last) const {
  Run run;
  for (const LaneStretch& stretch : lanesBefore(first)) run.append(network_, stretch);
  for (std::size_t i = first; i <= last; ++i) {
    LaneStretch whole = drive_[i];
    if (i > 0) whole.begin = 0.0;
    if (i + 1 < drive_.size()) whole.end = lengthOf(network_, whole.lane);
    const double begin = run.append(network_, whole);
    if (i == first) run.in = begin + drive_[i].begin - whole.begin;
    if (i == last) run.out = begin + drive_[i].end - whole.begin;
  }
  for (const LaneStretch& stretch : lanesAfter(last)) run.append(network_, stretch);
  run.line = geometry::Polyline(run.points);
  return run;
}

/// Lanes that lead to the first lane of a run and lie beside the route that is driven before the
/// change to it.
std::vector<LaneStretch> RouteBuilder::lanesBefore(std::size_t first) const {
  std::vector<LaneStretch> lanes;
  if (first == 0) return lanes;
  const bool to_left = network_.lane(drive_[first - 1].lane).left == drive_[first].lane;
  double length = 0.0;
  LaneIndex head = drive_[first].lane;
  for (std::size_t i = first - 1; i > 0 && length < kBlendLength; --i) {
    if (!follows(network_, drive_[i - 1].lane, drive_[i].lane)) break;
    const Lane& beside = network_.lane(drive_[i - 1].lane);
    const LaneIndex lane = to_left ? beside.left : beside.right;
    if (lane == kNoLane || !follows(network_, lane, head)) break;
    const double begin = arcLengthAbreast(network_, drive_[i - 1].lane, drive_[i - 1].begin, lane);
    lanes.insert(lanes.begin(), {lane, begin, lengthOf(network_, lane)});
    length += lanes.front().end - lanes.front().begin;
    head = lane;
  }
  return lanes;
}

/// Lanes that follow the last lane of a run and lie beside the route that is driven after the
/// change away from it.
std::vector<LaneStretch> RouteBuilder::lanesAfter(std::size_t last) const {
  std::vector<LaneStretch> lanes;
  if (last + 1 >= drive_.size()) return lanes;
  const bool to_left = network_.lane(drive_[last].lane).left == drive_[last + 1].lane;
  double length = 0.0;
  LaneIndex tail = drive_[last].lane;
  for (std::size_t i = last + 2; i < drive_.size() && length < kBlendLength; ++i) {
    if (!follows(network_, drive_[i - 1].lane, drive_[i].lane)) break;
    const Lane& beside = network_.lane(drive_[i].lane);
    const LaneIndex lane = to_left ? beside.right : beside.left;
    if (lane == kNoLane || !follows(network_, tail, lane)) break;
    const double end = arcLengthAbreast(network_, drive_[i].lane, drive_[i].end, lane);
    lanes.push_back({lane, 0.0, end});
    length += lanes.back().end;
    tail = lane;
  }
  return lanes;
}

/// Where the change from run `change` to the next is blended: as near to the change as the room on
/// both sides allows.
RouteBuilder::Window RouteBuilder::windowAt(std::size_t change) const {
  const Run& from = runs_[change];
  const Run& to = runs_[change + 1];
  const double driven_before = from.out - from.in;
  const double driven_after = to.out - to.in;
  double before = change == 0 ? from.out : driven_before / 2.0;
  double after = change + 2 == runs_.size() ? driven_after : driven_after / 2.0;
  before = std::max(0.0, std::min(before, to.in));
  after = std::max(0.0, std::min(after, from.line.length() - from.out));
  Window window;
  window.length = std::min(kBlendLength, before + after);
  window.begin = std::clamp(-window.length / 2.0, -before, after - window.length);
  return window;
}

void RouteBuilder::addSample(const Eigen::Vector3d& point, LaneIndex lane) {
  if (!points_.empty() && (point - points_.back()).head<2>().norm() < kSamePoint) return;
  points_.push_back(point);
  lanes_.push_back(lane);
}

void RouteBuilder::sampleRun(const Run& run, double begin, double end) {
  if (end < begin) return;
  const int count = std::max(1, static_cast<int>(std::ceil((end - begin) / kSampleSpacing)));
  for (int i = 0; i <= count; ++i) {
    const double arc_length = begin + (end - begin) * i / count;
    addSample(run.line.pointAt(arc_length), run.laneAt(arc_length));
  }
}

void RouteBuilder::sampleBlend(const Run& from, const Run& to, const Window& window) {
  const int count = std::max(1, static_cast<int>(std::ceil(window.length / kSampleSpacing)));
  for (int i = 1; i < count; ++i) {
    const double t = static_cast<double>(i) / count;
    const double weight = t * t * (3.0 - 2.0 * t);
    const double offset = window.begin + window.length * t;
    const Eigen::Vector3d old_point = from.line.pointAt(from.out + offset);
    const Eigen::Vector3d new_point = to.line.pointAt(to.in + offset);
    const bool changed = t >= 0.5;
    addSample(old_point + weight * (new_point - old_point),
              changed ? to.laneAt(to.in + offset) : from.laneAt(from.out + offset));
  }
}

/// The first sample after `last` that lies just ahead of it again, or the number of samples.
std::size_t RouteBuilder::passedAgain(std::size_t last, const Eigen::Vector2d& along) const {
  constexpr double kBeside = 3.0;            // [m]
  constexpr std::size_t kMostSamples = 240;  // 60 m there and back
  const std::size_t end = std::min(points_.size() - 1, last + kMostSamples);
  for (std::size_t i = last + 2; i < end; ++i) {
    const Eigen::Vector2d offset = (points_[i] - points_[last]).head<2>();
    const Eigen::Vector2d onwards = (points_[i + 1] - points_[i]).head<2>();
    if (along.dot(offset) > 0.0 && offset.norm() < kBeside && along.dot(onwards) > 0.0) return i;
  }
  return points_.size();
}

/// netconvert lets edges overlap and joins them by internal lanes that lead backwards, up to 8 m in
/// Town03. Such a jog is left out: the line goes on where it comes past the point again.
void RouteBuilder::dropOverlaps() {
  std::vector<Eigen::Vector3d> points = {points_.front()};
  std::vector<LaneIndex> lanes = {lanes_.front()};
  std::size_t last = 0;
  for (std::size_t i = 1; i < points_.size(); ++i) {
    if (i > 1 && points.size() > 1) {
      const Eigen::Vector2d along = (points.back() - points[points.size() - 2]).head<2>();
      const bool backwards = along.dot((points_[i] - points.back()).head<2>()) < 0.0;
      const std::size_t again = backwards ? passedAgain(last, along) : i;
      if (again < points_.size()) i = again;
    }
    points.push_back(points_[i]);
    lanes.push_back(lanes_[i]);
    last = i;
  }
  points_ = std::move(points);
  lanes_ = std::move(lanes);
}

/// Rounds the corners that centerlines have in junctions: mean over 1.5 m to both sides, less at
/// the ends, which stay.
std::vector<Eigen::Vector3d> roundedCorners(const std::vector<Eigen::Vector3d>& points) {
  std::vector<Eigen::Vector3d> rounded;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::size_t side = std::min({i, points.size() - 1 - i, kRoundingSamples});
    Eigen::Vector3d offset = Eigen::Vector3d::Zero();
    for (std::size_t j = i - side; j <= i + side; ++j) offset += points[j] - points[i];
    rounded.push_back(points[i] + offset / static_cast<double>(2 * side + 1));
  }
  return rounded;
}

Route RouteBuilder::resample() const {
  if (points_.size() < 2) {
    throw core::InputError("the route on lane '" + network_.lane(drive_.front().lane).id +
                           "' has no length; a start before its goal was expected");
  }
  const geometry::Polyline dense(roundedCorners(points_));
  const int count = std::max(1, static_cast<int>(std::round(dense.length() / kPointSpacing)));
  std::vector<Eigen::Vector3d> points;
  std::vector<LaneIndex> lanes;
  const std::vector<double>& arcs = dense.arcLengths();
  for (int i = 0; i <= count; ++i) {
    const double arc_length = dense.length() * i / count;
    const auto after = std::upper_bound(arcs.begin(), arcs.end(), arc_length);
    points.push_back(dense.pointAt(arc_length));
    lanes.push_back(lanes_[static_cast<std::size_t>(after - arcs.begin()) - 1]);
  }
  return Route(network_, points, lanes);
}

}  // namespace

Route buildRoute(const RoadNetwork& network, const std::vector<LaneStretch>& drive) {
  return RouteBuilder(network, drive).build();
}

namespace {

constexpr double kChangeStretch = 60.0;  // [m] a change happens within so much of its lane

/// Lanes lanes[first..last] of a path that lie side by side.
struct SideBySide {
  std::size_t first = 0;
  std::size_t last = 0;
  double begin = 0.0;  ///< arc length on the first where the route enters [m]
  double end = 0.0;    ///< arc length on the last where the route leaves [m]
};

/// An arc length on the lane at place `from` of a path, carried over to the lane at place `to`
/// beside it.
double carriedOver(const RoadNetwork& network, const LanePath& path, std::size_t from,
                   std::size_t to, double arc_length) {
  while (from != to) {
    const std::size_t next = from < to ? from + 1 : from - 1;
    arc_length = arcLengthAbreast(network, path.lanes[from], arc_length, path.lanes[next]);
    from = next;
  }
  return arc_length;
}

void appendGroup(const RoadNetwork& network, const LanePath& path, const SideBySide& group,
                 std::vector<LaneStretch>& drive) {
  const double changes = static_cast<double>(group.last - group.first);
  const double leave = carriedOver(network, path, group.last, group.first, group.end);
  const double zone = std::clamp(leave - group.begin, 0.0, kChangeStretch * changes);
  double begin = group.begin;
  for (std::size_t i = group.first; i <= group.last; ++i) {
    const bool last = i == group.last;
    const double done = static_cast<double>(i - group.first) + 0.5;
    const double change = last ? 0.0 : group.begin + zone * done / changes;
    double end = last ? group.end : carriedOver(network, path, group.first, i, change);
    end = std::max(begin, end);
    if (i == 0 && !drive.empty() && drive.back().lane == path.lanes[i]) {
      drive.back().end = std::max(drive.back().end, end);
    } else {
      drive.push_back({path.lanes[i], begin, end});
    }
    if (!last) begin = arcLengthAbreast(network, path.lanes[i], end, path.lanes[i + 1]);
  }
}

}  // namespace

bool follows(const RoadNetwork& network, LaneIndex from, LaneIndex to) {
  const std::vector<LaneLink>& next = network.lane(from).next;
  return std::any_of(next.begin(), next.end(), [&](const LaneLink& link) { return link.to == to; });
}

void appendPath(const RoadNetwork& network, const LanePath& path, double start, double goal,
                std::vector<LaneStretch>& drive) {
  std::size_t first = 0;
  for (std::size_t i = 1; i <= path.lanes.size(); ++i) {
    const bool last = i == path.lanes.size();
    if (!last && !follows(network, path.lanes[i - 1], path.lanes[i])) continue;
    SideBySide group;
    group.first = first;
    group.last = i - 1;
    if (first == 0) group.begin = start;
    group.end = last ? goal : lengthOf(network, path.lanes[i - 1]);
    appendGroup(network, path, group, drive);
    first = i;
  }
}

}  // namespace cdiff::map
