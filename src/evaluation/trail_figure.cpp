// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/trail_figure.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "core/csv.h"
#include "core/text.h"
#include "evaluation/contact_counts.h"
#include "evaluation/paper/frame_figure.h"
#include "evaluation/trail_scene.h"
#include "metrics/known_measures.h"
#include "page/pictures/charts.h"
#include "page/pictures/top_view.h"

namespace cdiff::evaluation {
namespace {

using core::Markup;
using record::TraceRow;
using traffic::VehicleRole;

constexpr std::size_t kShades = 6;        // of a trail, from light to dark
constexpr std::size_t kScenesInRow = 2;   // panels
constexpr double kSceneWidth = 560.0;     // [pixels]
constexpr double kLeastHeight = 160.0;    // [pixels]
constexpr double kMostHeight = 420.0;     // [pixels]
constexpr double kTextHeight = 20.0;      // below a panel [pixels]
constexpr double kSceneMargin = 12.0;     // around all trails [m]
constexpr double kContactRadius = 9.0;    // of a mark [pixels]
constexpr double kSecondsPerPlace = 0.5;  // in the CSV file
constexpr const char* kTrailHeader = ",tick,seconds,vehicle_id,role,x,y,contact_with\n";

/// What all panels share, so that they can be compared.
struct SceneView {
  page::MapCanvas canvas;
  std::uint64_t end = 0;  ///< last tick of the longest run
};

SceneView viewOf(const std::vector<DrivenScene>& scenes) {
  page::Region region{Eigen::Vector2d::Constant(1e9), Eigen::Vector2d::Constant(-1e9)};
  std::uint64_t end = 0;
  for (const DrivenScene& scene : scenes) {
    for (const TraceRow& row : scene.rows) {
      end = std::max(end, row.tick);
      if (row.role == VehicleRole::kBackground) continue;
      region.low = region.low.cwiseMin(row.position);
      region.high = region.high.cwiseMax(row.position);
    }
  }
  region = region.grown(kSceneMargin);
  const Eigen::Vector2d size = region.high - region.low;
  const double height = std::clamp(kSceneWidth * size.y() / size.x(), kLeastHeight, kMostHeight);
  return {page::MapCanvas(region, {kSceneWidth, height}), end};
}

/// Path data by shade of the trails that vehicles drove in a role.
std::array<std::string, kShades> shadedTrails(const std::vector<TraceRow>& rows, VehicleRole role,
                                              const SceneView& view) {
  struct Stretch {
    page::Points points;
    std::uint64_t tick = 0;
    std::size_t shade = 0;
  };
  std::map<std::string, Stretch> open;
  std::array<std::string, kShades> paths;
  for (const TraceRow& row : rows) {
    if (row.role != role) continue;
    Stretch& stretch = open[row.id];
    const std::size_t shade = kShades * row.tick / (view.end + 1);
    const bool goes_on = !stretch.points.empty() && stretch.tick + 1 == row.tick;
    if (goes_on) stretch.points.push_back(row.position);
    if (!goes_on || shade != stretch.shade) {
      paths[stretch.shade] += view.canvas.line(stretch.points);
      stretch.points = {row.position};
    }
    stretch.tick = row.tick;
    stretch.shade = shade;
  }
  for (const auto& [id, stretch] : open) paths[stretch.shade] += view.canvas.line(stretch.points);
  return paths;
}

std::string styleOfTrail(VehicleRole role, std::size_t shade) {
  return std::string("trail ") + traffic::toText(role) + " t" + std::to_string(shade);
}

Markup trailsSvg(const DrivenScene& scene, VehicleRole role, const SceneView& view) {
  Markup svg;
  const auto paths = shadedTrails(scene.rows, role, view);
  for (std::size_t shade = 0; shade < kShades; ++shade)
    svg += page::svgPath(styleOfTrail(role, shade), paths[shade]);
  return svg;
}

/// The vehicles where the role was theirs last.
Markup endsSvg(const DrivenScene& scene, VehicleRole role, const SceneView& view) {
  Markup svg;
  std::map<std::string, const TraceRow*> last;
  for (const TraceRow& row : scene.rows) {
    if (row.role == role) last[row.id] = &row;
  }
  const traffic::VehicleDimensions size;  // the trace does not hold it
  for (const auto& [id, row] : last) {
    svg +=
        page::vehicleSvg({id, size.length, size.width}, {row->position, row->heading}, view.canvas,
                         traffic::toText(role), page::vehicleMagnification(view.canvas));
  }
  return svg;
}

Markup touchesSvg(const DrivenScene& scene, const SceneView& view) {
  Markup svg;
  for (const TouchPlace& touch : scene.touches) {
    const std::string text = "contact of " + touch.vehicle + " and " + touch.partner + " at " +
                             core::formatFixed(static_cast<double>(touch.tick) * scene.step, 2) +
                             " s";
    svg += page::svgCircle("contact", view.canvas.toPixels(touch.position), kContactRadius,
                           core::element("title", {}, text)) +
           "\n";
  }
  return svg;
}

/// "98.2 % of the route, driving score 68.7, 1 contact, 8.1 % off the road"; "?" for a measure that
/// the run does not have.
std::string courseOf(const BatchRun& run) {
  namespace known = metrics::known;
  const auto text = [&run](const metrics::MeasureDefinition& measure, int digits) {
    const std::optional<double> value = run.number(measure.place);
    return value ? core::formatFixed(*value, digits) : "?";
  };
  const std::string contacts = text(known::kEgoCollisions, 0);
  return text(known::kRouteCompletion, 1) + " % of the route, driving score " +
         text(known::kDrivingScore, 1) + ", " + contacts +
         (contacts == "1" ? " contact, " : " contacts, ") + text(known::kEgoOffRoad, 1) +
         " % off the road";
}

std::string contactsText(double count) {
  return core::formatFixed(count, 0) + (count == 1.0 ? " contact" : " contacts");
}

/// "3 contacts of the ego (2 with CBVs + 1 with background), 1 contact of CBVs with others" or "no
/// contact": the circles of the picture.
std::string touchesText(const BatchRun& run) {
  namespace known = metrics::known;
  ContactCounts ego;
  ego.with_cbvs = run.number(known::kCbvEgoCollisions.place).value_or(0.0);
  ego.all = std::max(ego.with_cbvs, run.number(known::kEgoCollisions.place).value_or(0.0));
  const double others =
      run.number(known::kCbvCollisions.place).value_or(ego.with_cbvs) - ego.with_cbvs;
  std::vector<std::string> parts;
  if (ego.all > 0.0)
    parts.push_back(contactsText(ego.all) + " of the ego (" + kindsText(ego) + ")");
  if (others > 0.0) parts.push_back(contactsText(others) + " of CBVs with others");
  return parts.empty() ? "no contact" : core::joinText(parts, ", ");
}

/// The contacts, then "nearest CBV 4.1 m" or "no CBV was driven".
std::string countsOf(const BatchRun& run) {
  const auto nearest = run.number(metrics::known::kCbvMinimumDistance.place);
  return touchesText(run) + (nearest ? ", nearest CBV " + core::formatFixed(*nearest, 1) + " m"
                                     : ", no CBV was driven");
}

page::Panel scenePanel(const DrivenScene& scene, const SceneView& view,
                       const session::SessionSetup* setup, TrailsOf who) {
  page::Panel panel;
  panel.title = scene.planner;
  const double height = view.canvas.height();
  panel.width = kSceneWidth;
  panel.height = height + kTextHeight;
  Markup map = groundSvg(setup, view.canvas);
  for (const VehicleRole role : {VehicleRole::kEgo, VehicleRole::kCbv})
    map += trailsSvg(scene, role, view);
  for (const VehicleRole role : {VehicleRole::kCbv, VehicleRole::kEgo})
    map += endsSvg(scene, role, view);
  map += touchesSvg(scene, view) + page::scaleBarSvg(view.canvas);
  panel.content =
      core::element("svg", {{"width", kSceneWidth}, {"height", height}}, "\n" + map) + "\n" +
      page::chartText("note", 0.0, height + 15.0,
                      who == TrailsOf::kEgo ? courseOf(*scene.run) : countsOf(*scene.run));
  return panel;
}

std::string placesOf(const DrivenScene& scene) {
  const auto stride = std::max<std::uint64_t>(1, std::llround(kSecondsPerPlace / scene.step));
  std::string text;
  const auto add = [&](std::uint64_t tick, const std::string& id, const std::string& role,
                       const Eigen::Vector2d& place, const std::string& partner) {
    text += core::csvRow({scene.planner, std::to_string(tick),
                          core::formatFixed(static_cast<double>(tick) * scene.step, 2), id, role,
                          core::formatNumber(place.x()), core::formatNumber(place.y()), partner});
  };
  for (const TraceRow& row : scene.rows) {
    if (row.role != VehicleRole::kBackground && row.tick % stride == 0)
      add(row.tick, row.id, traffic::toText(row.role), row.position, "");
  }
  for (const TouchPlace& touch : scene.touches)
    add(touch.tick, touch.vehicle, "contact", touch.position, touch.partner);
  return text;
}

/// What scene it is, how it is drawn, and planners whose runs broke.
void addNotes(const std::vector<BatchRun>& runs, const DrivenScene& first, const SceneView& view,
              TrailsOf who, page::PanelSheet& sheet) {
  std::vector<std::string> levels;
  const Factors scene = sceneOf(*first.run, who);
  for (const std::string& factor : factorNames()) {
    const auto level = scene.find(factor);
    if (level != scene.end() && !level->second.empty())
      levels.push_back(factor + " " + level->second);
  }
  const double shade = static_cast<double>(view.end) * first.step / static_cast<double>(kShades);
  sheet.legend = {{styleOfTrail(VehicleRole::kEgo, kShades - 1), "ego"},
                  {styleOfTrail(VehicleRole::kCbv, kShades - 1), "CBVs, while they were driven"}};
  sheet.notes.push_back("The same scene: " + core::joinText(levels, ", ") + ".");
  sheet.notes.push_back("Trails darken with time, every " + core::formatFixed(shade, 1) +
                        " s; boxes (of the default size): where they end; circles: contacts of "
                        "ego and CBVs. Below each picture " +
                        (who == TrailsOf::kEgo
                             ? "what became of the ego; off the road is its center."
                             : "these contacts, and the smallest distance between centers of a "
                               "CBV and the ego."));
  for (const BatchRun& run : runs) {
    if (run.record.complete() || sceneOf(run, who) != scene) continue;
    sheet.notes.push_back(run.record.factors.at(factorOf(who)) + ": " + run.record.status +
                          (run.record.cause.empty() ? "" : ", " + run.record.cause));
  }
}

}  // namespace

std::optional<Figure> trailFigure(const std::vector<BatchRun>& runs, TrailsOf who) {
  const std::vector<DrivenScene> scenes = chosenScene(runs, who);
  if (scenes.empty()) return std::nullopt;
  Figure figure;
  figure.id = who == TrailsOf::kEgo ? "ego_trails" : "trails";
  figure.csv = factorOf(who) + kTrailHeader;
  figure.sheet.title = std::string("One scene, driven by each ") +
                       (who == TrailsOf::kEgo ? "ego planner" : "CBV planner");
  const SceneView view = viewOf(scenes);
  addNotes(runs, scenes.front(), view, who, figure.sheet);
  const auto setup = roadsOf(*scenes.front().run, figure.sheet);
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    if (i % kScenesInRow == 0) figure.sheet.rows.emplace_back();
    figure.sheet.rows.back().push_back(scenePanel(scenes[i], view, setup.get(), who));
    figure.csv += placesOf(scenes[i]);
  }
  return figure;
}

}  // namespace cdiff::evaluation
