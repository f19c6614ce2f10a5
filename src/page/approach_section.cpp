// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "page/approach_section.h"

#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "e2e_cdiff/traffic/vehicle.h"
#include "page/page_parts.h"
#include "page/pictures/camera_strip.h"
#include "page/pictures/charts.h"
#include "page/pictures/map_canvas.h"
#include "page/pictures/top_view.h"
#include "record/logs/cbv_log.h"

namespace cdiff::page {
namespace {

using traffic::VehicleRole;

constexpr double kPlanRounding = 1e-6;  // [s]

/// The plan's horizon: planned and driven states of the CBV every 0.1 s from the decision on, and
/// where the ego was.
struct PlanView {
  std::vector<record::Waypoint> planned;
  std::vector<record::Waypoint> driven;
  std::vector<geometry::Pose2d> ego;
  record::TimelineVehicle ego_vehicle;
};

void addEgo(const record::SessionResult& result, const record::LoggedPlan& plan, PlanView& view) {
  for (const record::TimelineFrame& frame : result.timeline.frames()) {
    const bool within = frame.time >= plan.time - kPlanRounding &&
                        frame.time <= plan.time + plan.horizon() + kPlanRounding;
    if (!within || frame.poses.empty()) continue;
    const record::TimelinePose& pose = frame.poses.front();  // the ego comes first
    if (pose.role != VehicleRole::kEgo) continue;
    view.ego.push_back({{pose.x, pose.y}, static_cast<double>(pose.heading)});
    view.ego_vehicle = result.timeline.vehicles()[pose.vehicle];
  }
}

PlanView viewOf(const record::SessionResult& result, const record::VehiclePlans& vehicle,
                const record::LoggedPlan& plan) {
  PlanView view;
  view.planned.push_back(plan.start);
  view.driven.push_back(plan.start);
  for (std::size_t i = 0; i < plan.points.size(); ++i) {
    view.planned.push_back(plan.points[i]);
    const double seconds = static_cast<double>(i + 1) * traffic::kRolloutStep;
    if (const auto state = result.plans.drivenAfter(vehicle, plan, seconds)) {
      view.driven.push_back(*state);
    }
  }
  addEgo(result, plan, view);
  return view;
}

Points positionsOf(const std::vector<record::Waypoint>& states) {
  Points points;
  for (const record::Waypoint& state : states) points.push_back(state.position);
  return points;
}

Region regionOf(const PlanView& view) {
  constexpr double kMargin = 8.0;     // [m]
  constexpr double kEgoReach = 45.0;  // of the ego from the CBV that is still shown [m]
  const Eigen::Vector2d start = view.planned.front().position;
  Region region{start, start};
  const auto include = [&](const Eigen::Vector2d& point) {
    region.low = region.low.cwiseMin(point);
    region.high = region.high.cwiseMax(point);
  };
  for (const auto* states : {&view.planned, &view.driven}) {
    for (const record::Waypoint& state : *states) {
      if (state.position.allFinite()) include(state.position);
    }
  }
  for (const geometry::Pose2d& pose : view.ego) {
    if ((pose.position - start).norm() < kEgoReach) include(pose.position);
  }
  return region.grown(kMargin);
}

/// A dot every 0.5 s.
Markup dots(const std::vector<record::Waypoint>& states, const std::string& style,
            const MapCanvas& canvas) {
  constexpr std::size_t kStride = 5;
  Markup svg;
  for (std::size_t i = kStride; i < states.size(); i += kStride) {
    if (states[i].position.allFinite())
      svg += svgCircle(style, canvas.toPixels(states[i].position), 3.0);
  }
  return svg + "\n";
}

/// What the planner weighed, from the vehicle on: the best few on top of the others.
Markup candidatesSvg(const record::LoggedPlan& plan, const MapCanvas& canvas) {
  constexpr std::size_t kBest = 3;
  std::vector<const record::LoggedCandidate*> order;
  for (const record::LoggedCandidate& candidate : plan.candidates) order.push_back(&candidate);
  std::stable_sort(order.begin(), order.end(),
                   [](const auto* left, const auto* right) { return left->score < right->score; });
  Markup svg;
  for (std::size_t i = 0; i < order.size(); ++i) {
    Points line = {plan.start.position};
    for (const Eigen::Vector2d& place : order[i]->places) {
      if (place.allFinite()) line.push_back(place);
    }
    const bool best = i + kBest >= order.size();
    svg += svgPath(best ? "candidate best" : "candidate", canvas.line(line),
                   "weighed with score " + core::formatFixed(order[i]->score, 3));
  }
  return svg;
}

/// What was driven, with the CBV's box at both ends, and what was planned.
Markup statesSvg(const record::VehiclePlans& vehicle, const PlanView& view,
                 const std::string& style, const MapCanvas& canvas) {
  const record::TimelineVehicle body{vehicle.vehicle_id, vehicle.dimensions.length,
                                     vehicle.dimensions.width};
  const auto box = [&](const record::Waypoint& state, const std::string& box_style) {
    return vehicleSvg(body, {state.position, state.heading}, canvas, box_style);
  };
  const Markup driven = box(view.driven.front(), style) +
                        box(view.driven.back(), style + " later") +
                        svgPath("trail " + style, canvas.line(positionsOf(view.driven))) +
                        dots(view.driven, "stop " + style, canvas);
  if (!view.planned.back().position.allFinite()) return driven;
  return driven + box(view.planned.back(), "plan-end") +
         svgPath("plan", canvas.line(positionsOf(view.planned))) +
         dots(view.planned, "plan-stop", canvas);
}

Markup fromAbove(const record::SessionResult& result, const record::VehiclePlans& vehicle,
                 const record::LoggedPlan& plan, const PlanView& view, const std::string& style) {
  const Eigen::Vector2d size(540.0, 360.0);  // [pixels]
  const MapCanvas canvas(regionOf(view), size);
  Markup svg = roadSvg(result.setup, canvas) + candidatesSvg(plan, canvas);
  if (!view.ego.empty()) {
    Points trail;
    for (const geometry::Pose2d& pose : view.ego) trail.push_back(pose.position);
    svg += svgPath("trail ego", canvas.line(trail)) +
           vehicleSvg(view.ego_vehicle, view.ego.front(), canvas, "ego");
  }
  svg += statesSvg(vehicle, view, style, canvas) + scaleBarSvg(canvas);
  return chartFigure("plan-view", "From above",
                     svgPicture("Plan and drive from above", size, {}, svg));
}

Markup speeds(const PlanView& view, const std::string& style) {
  Chart chart;
  chart.title = "Speed since the decision";
  chart.unit = "m/s";
  chart.own_time = true;
  chart.least_top = 5.0;
  chart.duration = static_cast<double>(view.planned.size() - 1) * traffic::kRolloutStep;
  const auto series = [](const std::string& name, const std::vector<record::Waypoint>& states) {
    ChartSeries line{name, {}};
    for (std::size_t i = 0; i < states.size(); ++i) {
      line.points.emplace_back(static_cast<double>(i) * traffic::kRolloutStep, states[i].speed);
    }
    return line;
  };
  chart.series = {series("plan", view.planned), series(style, view.driven)};
  return chartSvg(chart);
}

Markup planLegend(const std::string& style, bool weighed) {
  Markup lines = legendLine("plan", "planned by the CBV at this decision");
  if (weighed) {
    lines += legendLine("candidate best", "weighed, the three of the largest scores") +
             legendLine("candidate", "weighed, the others");
  }
  return pageLegend(lines + legendLine("trail " + style, "driven by the CBV") +
                    legendLine("trail ego", "driven by the ego"));
}

}  // namespace

Markup planPictures(const record::SessionResult& result, const record::VehiclePlans& vehicle,
                    const record::LoggedPlan& plan) {
  const PlanView view = viewOf(result, vehicle, plan);
  const std::string style = styleOf(VehicleRole::kCbv, vehicle.vehicle_id, result.cbv);
  const double apart = (view.planned.back().position - view.driven.back().position).norm();
  const std::string end =
      std::isfinite(apart) ? core::formatFixed(apart, 2) + " m apart at the end" : "not finite";
  const std::string heading = "Plan of the decision at " + core::formatFixed(plan.time, 2) +
                              " s against what was driven in the next " +
                              core::formatFixed(plan.horizon(), 1) + " s: " + end;
  const Markup pictures = fromAbove(result, vehicle, plan, view, style) + speeds(view, style);
  return element("h4", {}, heading) + "\n" + planLegend(style, !plan.candidates.empty()) +
         element("div", {{"class", "charts"}}, "\n" + pictures) + "\n" +
         pageNote(
             "Filled boxes: at the decision; outlined: at the plan's end. A dot every 0.5 s. Later "
             "decisions may change the plan.");
}

namespace {

constexpr double kLookBack = 3.0;  // from the closest approach to the plan that is shown [s]

Markup view(const traffic::CameraImage& image, const std::string& style,
            const std::string& caption) {
  const Markup picture = element("img", {{"width", image.width},
                                         {"height", image.height},
                                         {"alt", caption},
                                         {"src", record::pngDataUri(image)}});
  return element("figure", {{"class", style}}, picture + element("figcaption", {}, caption)) + "\n";
}

std::string speedText(const traffic::Vehicle& vehicle) {
  return core::formatFixed(vehicle.state.speed, 1) + " m/s";
}

/// What a vehicle saw: for people, and as the planner got it.
Markup views(rendering::FrontCamera& camera, const record::Approach& approach,
             const traffic::Vehicle& vehicle, const std::string& name,
             const traffic::CameraImage& seen) {
  const Markup people = view(camera.render(approach.snapshot, vehicle), "view",
                             "From the " + name + " at " + core::formatFixed(approach.time(), 2) +
                                 " s, " + speedText(vehicle));
  if (seen.empty()) return people;
  const double step_age = static_cast<double>(approach.snapshot.tick - seen.tick);
  const std::string when = step_age > 0.0 ? " at the decision " + core::formatFixed(step_age, 0) +
                                                (step_age > 1.0 ? " ticks" : " tick") + " before"
                                          : " at this tick";
  return people +
         view(seen, "view small",
              "What the planner of the " + name + " saw" + when + ": " +
                  std::to_string(seen.width) + " × " + std::to_string(seen.height) + " pixels");
}

Markup planPart(const record::SessionResult& result, const record::Approach& approach) {
  const record::VehiclePlans* vehicle = result.plans.find(approach.vehicle_id);
  if (vehicle == nullptr || vehicle->plans.empty()) return {};
  const record::LoggedPlan* plan =
      result.plans.drivenPlanNear(*vehicle, approach.time() - kLookBack);
  if (plan == nullptr) return pageNote("It was not driven long enough to follow a whole plan.");
  return planPictures(result, *vehicle, *plan);
}

Markup approachPart(const record::SessionResult& result, const record::Approach& approach,
                    rendering::FrontCamera& camera) {
  const traffic::Vehicle* ego = approach.snapshot.ego();
  const traffic::Vehicle* cbv = approach.snapshot.find(approach.vehicle_id);
  if (ego == nullptr || cbv == nullptr) return {};
  const std::string gap = approach.gap > 0.0
                              ? core::formatFixed(approach.gap, 2) + " m between outlines"
                              : "the outlines overlap";
  const Markup heading =
      approach.vehicle_id + Markup(" at ") + timeLink(approach.time()) + " s: " + gap;
  const std::string line = core::formatFixed(approach.center_distance, 1) +
                           " m between centers; CBV " + speedText(*cbv) + ", ego " +
                           speedText(*ego);
  const Markup seen = views(camera, approach, *cbv, "CBV", approach.cbv_image) +
                      views(camera, approach, *ego, "ego", approach.ego_image);
  const Markup content = element("h3", {}, heading) + "\n" +
                         element("p", {{"class", "sub"}}, line) + "\n" +
                         element("div", {{"class", "views"}}, "\n" + seen) + "\n" +
                         cameraStrip(approach.cbv_views, "CBV") +
                         cameraStrip(approach.ego_views, "ego") + planPart(result, approach);
  const std::string style = styleOf(VehicleRole::kCbv, approach.vehicle_id, result.cbv);
  return element("article", {{"class", "approach " + style}}, "\n" + content) + "\n";
}

}  // namespace

Markup approachSection(const record::SessionResult& result) {
  const std::vector<const record::Approach*> shown = result.approaches.nearest();
  if (shown.empty()) {
    return pageNote("No CBV was driven near the ego.") +
           cameraStrip(result.approaches.latestViews(traffic::kEgoSlot), "ego");
  }
  rendering::FrontCamera camera = result.front_views.camera(640, 384);
  Markup html;
  const std::size_t count = result.approaches.approaches().size();
  if (count > shown.size()) {
    html += pageNote("The " + std::to_string(shown.size()) + " nearest of " +
                     std::to_string(count) + " CBVs.");
  }
  for (const record::Approach* approach : shown) html += approachPart(result, *approach, camera);
  return html;
}

}  // namespace cdiff::page
