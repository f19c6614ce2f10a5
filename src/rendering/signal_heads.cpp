// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "rendering/signal_heads.h"

#include <algorithm>

namespace cdiff::rendering {
namespace {

constexpr double kStopLineWidth = 0.5;  // [m]
constexpr double kStopLineBack = 0.25;  // [m] its middle before the lane's end
constexpr double kBehindLine = 2.5;     // [m] lamps behind the stop line
constexpr double kLampHeight = 3.1;     // [m] its middle above the road
constexpr double kArmHeight = 3.9;      // [m]
constexpr double kMastBeside = 0.7;     // [m] right of the rightmost lane
constexpr double kMastRadius = 0.08;    // [m]
constexpr double kHousingHalfWidth = 0.34;
constexpr double kHousingHalfHeight = 0.85;
constexpr double kBulbRadius = 0.24;
constexpr double kBulbSpacing = 0.54;
constexpr Color kHousing = rgb(26, 28, 30);
constexpr Color kMast = rgb(88, 92, 96);
/// Unlit and lit bulbs from the top: red, yellow, green.
constexpr Color kUnlit[3] = {rgb(70, 20, 20), rgb(70, 60, 16), rgb(16, 60, 26)};
constexpr Color kLit[3] = {rgb(255, 40, 32), rgb(255, 208, 24), rgb(40, 240, 96)};

constexpr Label kSignalLabel = {SceneClass::kSignal, 0};

/// Rank of a turn among those that a lane offers: the straightest shows the color.
int straightness(char direction) {
  const std::string order = "srRlLt";
  const std::size_t at = order.find(direction);
  return static_cast<int>(at == std::string::npos ? order.size() : at);
}

const map::LaneLink* shownLink(const map::Lane& lane) {
  const map::LaneLink* shown = nullptr;
  for (const map::LaneLink& link : lane.next) {
    if (link.signal_id.empty() || link.signal_link < 0) continue;
    if (!shown || straightness(link.direction) < straightness(shown->direction)) shown = &link;
  }
  return shown;
}

Eigen::Vector3d lift(const Eigen::Vector2d& point, double height) {
  return {point.x(), point.y(), height};
}

Eigen::Vector2d endDirection(const map::Lane& lane) {
  const auto& points = lane.centerline.points();
  return (points.back() - points[points.size() - 2]).head<2>().normalized();
}

/// Middle and directions of a lamp's face (optical frame).
struct LampFrame {
  Eigen::Vector3d middle;
  Eigen::Vector3d left;
  Eigen::Vector3d up;

  Eigen::Vector3d at(double left_offset, double up_offset) const {
    return middle + left * left_offset + up * up_offset;
  }
};

void paintHousing(const LampFrame& frame, Canvas& canvas) {
  const Eigen::Vector3d corners[4] = {frame.at(kHousingHalfWidth, kHousingHalfHeight),
                                      frame.at(-kHousingHalfWidth, kHousingHalfHeight),
                                      frame.at(-kHousingHalfWidth, -kHousingHalfHeight),
                                      frame.at(kHousingHalfWidth, -kHousingHalfHeight)};
  canvas.fill(corners, 4, {kHousing, rank::kBody, 1.0, kSignalLabel});
}

/// An octagon.
void paintBulb(const LampFrame& frame, double height, Color color, Canvas& canvas) {
  static constexpr double kCut = 0.41421356237309503;  // tan(22.5 deg)
  static constexpr double kOctagon[8][2] = {{1, kCut},   {kCut, 1},   {-kCut, 1}, {-1, kCut},
                                            {-1, -kCut}, {-kCut, -1}, {kCut, -1}, {1, -kCut}};
  Eigen::Vector3d corners[8];
  for (int i = 0; i < 8; ++i) {
    corners[i] = frame.at(kBulbRadius * kOctagon[i][0], height + kBulbRadius * kOctagon[i][1]);
  }
  canvas.fill(corners, 8, {color, rank::kBodyDetail, 1.0, kSignalLabel});
}

}  // namespace

LampColor lampColorOf(char letter) {
  switch (letter) {
    case 'r':
    case 's':
      return LampColor::kRed;
    case 'y':
    case 'Y':
    case 'u':
      return LampColor::kYellow;
    case 'g':
    case 'G':
      return LampColor::kGreen;
    default:
      return LampColor::kDark;
  }
}

SignalHeads::SignalHeads(const map::RoadNetwork& network) {
  for (const map::Lane& lane : network.lanes()) {
    if (!lane.internal && lane.allows_cars) addLane(lane);
  }
  for (const std::string& edge : network.edgeIds()) addMast(network, edge);
  states_.resize(signal_by_id_.size());
  std::vector<Bound> bounds;
  for (const SignalHead& head : heads_) bounds.push_back({head.stop, 6.0});
  head_grid_ = SpatialGrid(std::move(bounds));
  bounds.clear();
  for (const SignalMast& mast : masts_) {
    const Eigen::Vector3d points[3] = {mast.base, mast.top, mast.arm_end};
    bounds.push_back(boundOf(points, 3));
  }
  mast_grid_ = SpatialGrid(std::move(bounds));
}

void SignalHeads::addLane(const map::Lane& lane) {
  const map::LaneLink* link = shownLink(lane);
  if (!link) return;
  SignalHead head;
  head.forward = endDirection(lane);
  head.stop = lane.centerline.points().back();
  head.stop.head<2>() -= kStopLineBack * head.forward;
  head.width = lane.width;
  const auto signal = static_cast<int>(signal_by_id_.size());
  head.signal = signal_by_id_.emplace(link->signal_id, signal).first->second;
  head.link = link->signal_link;
  heads_.push_back(head);
}

void SignalHeads::addMast(const map::RoadNetwork& network, const std::string& edge) {
  const map::Lane* first = nullptr;
  const map::Lane* last = nullptr;
  for (const map::LaneIndex index : network.lanesOfEdge(edge)) {
    const map::Lane& lane = network.lane(index);
    if (!lane.allows_cars || !shownLink(lane)) continue;
    if (!first) first = &lane;
    last = &lane;
  }
  if (!first) return;
  const Eigen::Vector2d forward = endDirection(*first);
  const Eigen::Vector3d end = first->centerline.points().back();
  const Eigen::Vector2d foot = end.head<2>() + kBehindLine * forward -
                               geometry::leftNormal(forward) * (0.5 * first->width + kMastBeside);
  const Eigen::Vector3d far_end = last->centerline.points().back();
  SignalMast mast;
  mast.base = lift(foot, end.z());
  mast.top = lift(foot, end.z() + kArmHeight);
  mast.arm_end = lift(far_end.head<2>() + kBehindLine * endDirection(*last), mast.top.z());
  masts_.push_back(mast);
}

void SignalHeads::look(const std::vector<View>& views,
                       const std::vector<traffic::SignalState>& signals) {
  head_grid_.visible(views, visible_heads_);
  mast_grid_.visible(views, visible_masts_);
  if (std::all_of(visible_heads_.begin(), visible_heads_.end(),
                  [](const std::vector<int>& heads) { return heads.empty(); }))
    return;
  read(signals);
}

std::vector<LampColor> SignalHeads::colorsOf(const std::vector<traffic::SignalState>& signals) {
  read(signals);
  std::vector<LampColor> colors;
  for (const SignalHead& head : heads_) colors.push_back(colorOf(head));
  return colors;
}

void SignalHeads::read(const std::vector<traffic::SignalState>& signals) {
  std::fill(states_.begin(), states_.end(), nullptr);
  for (const traffic::SignalState& signal : signals) {
    const auto known = signal_by_id_.find(signal.id);
    if (known != signal_by_id_.end()) {
      states_[static_cast<std::size_t>(known->second)] = &signal.state;
    }
  }
}

LampColor SignalHeads::colorOf(const SignalHead& head) const {
  const std::string* state = states_[static_cast<std::size_t>(head.signal)];
  const auto link = static_cast<std::size_t>(head.link);
  return state && link < state->size() ? lampColorOf((*state)[link]) : LampColor::kDark;
}

void SignalHeads::drawStopLines(std::size_t index, const View& view, Canvas& canvas) const {
  for (const int i : visible_heads_[index]) {
    const SignalHead& head = heads_[static_cast<std::size_t>(i)];
    const LampColor lamp = colorOf(head);
    const Color color = lamp == LampColor::kDark ? kWhitePaint : kLit[static_cast<int>(lamp) - 1];
    const Eigen::Vector2d left = geometry::leftNormal(head.forward) * (0.5 * head.width - 0.1);
    const Eigen::Vector2d middle = head.stop.head<2>();
    drawMarking(markingBetween(lift(middle - left, head.stop.z()),
                               lift(middle + left, head.stop.z()), kStopLineWidth, color),
                rank::kStopLine, view, canvas);
  }
}

void SignalHeads::drawLamps(std::size_t index, const View& view, Canvas& canvas) const {
  const Eigen::Vector3d right = {kMastRadius, 0.0, 0.0};
  const Eigen::Vector3d up = view.directionToCamera({0.0, 0.0, kMastRadius});
  for (const int i : visible_masts_[index]) {
    const SignalMast& mast = masts_[static_cast<std::size_t>(i)];
    canvas.line(view.toCamera(mast.base), view.toCamera(mast.top), right,
                {kMast, rank::kBody, 1.0, kSignalLabel});
    canvas.line(view.toCamera(mast.top), view.toCamera(mast.arm_end), up,
                {kMast, rank::kBody, 1.0, kSignalLabel});
  }
  for (const int i : visible_heads_[index])
    drawLamp(heads_[static_cast<std::size_t>(i)], view, canvas);
}

void SignalHeads::drawLamp(const SignalHead& head, const View& view, Canvas& canvas) const {
  const Eigen::Vector2d foot = head.stop.head<2>() + (kStopLineBack + kBehindLine) * head.forward;
  const LampFrame frame = {view.toCamera(lift(foot, head.stop.z() + kLampHeight)),
                           view.directionToCamera(lift(geometry::leftNormal(head.forward), 0.0)),
                           view.directionToCamera({0.0, 0.0, 1.0})};
  paintHousing(frame, canvas);
  if (head.forward.dot(view.eye().head<2>() - foot) >= 0.0) return;  // seen from behind
  const int lit = static_cast<int>(colorOf(head)) - 1;
  for (int i = 0; i < 3; ++i) {
    paintBulb(frame, kBulbSpacing * (1 - i), i == lit ? kLit[i] : kUnlit[i], canvas);
  }
}

}  // namespace cdiff::rendering
