// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "page/pictures/attention.h"

#include <algorithm>

#include "core/text.h"
#include "page/pictures/charts.h"
#include "page/pictures/map_canvas.h"

namespace cdiff::page {
namespace {

const record::TimelinePose* poseOfVehicle(const record::TimelineFrame& frame,
                                          std::uint32_t vehicle) {
  const auto found =
      std::find_if(frame.poses.begin(), frame.poses.end(),
                   [&](const record::TimelinePose& pose) { return pose.vehicle == vehicle; });
  return found == frame.poses.end() ? nullptr : &*found;
}

}  // namespace

bool showsAttention(const record::Timeline& timeline) {
  const auto& frames = timeline.frames();
  return std::any_of(frames.begin(), frames.end(),
                     [](const record::TimelineFrame& frame) { return !frame.gazes.empty(); });
}

core::Markup attentionSvg(const record::Timeline& timeline, const MapCanvas& canvas) {
  if (!showsAttention(timeline)) return {};
  core::Markup lines;
  const record::TimelineFrame& frame = timeline.frames().back();
  for (const record::TimelineAttention& gaze : frame.gazes) {
    const record::TimelinePose* from = poseOfVehicle(frame, gaze.driver);
    const record::TimelinePose* to = poseOfVehicle(frame, gaze.vehicle);
    if (from == nullptr || to == nullptr) continue;
    const Eigen::Vector2d begin = canvas.toPixels({from->x, from->y});
    const Eigen::Vector2d end = canvas.toPixels({to->x, to->y});
    lines += core::element(
        "path", {{"class", "gaze"},
                 {"d", "M" + svgPlace(begin.x(), begin.y()) + "L" + svgPlace(end.x(), end.y())},
                 {"style", "--weight:" + core::formatFixed(static_cast<double>(gaze.weight), 2)}});
  }
  return core::element("g", {{"id", "gazes"}}, lines) + "\n";
}

}  // namespace cdiff::page
