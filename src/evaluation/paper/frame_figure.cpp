// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/paper/frame_figure.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>

#include "core/csv.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "evaluation/paper/paper_figures.h"
#include "evaluation/paper/paper_table.h"
#include "metrics/known_measures.h"
#include "page/pictures/charts.h"
#include "page/pictures/map_canvas.h"
#include "page/pictures/top_view.h"
#include "record/result_folder.h"

namespace cdiff::evaluation {
namespace {

using core::Markup;
using record::TraceRow;
using traffic::VehicleRole;

constexpr std::array<double, 3> kOffsets = {-1.5, 0.0, 1.0};  // of frames to the approach [s]
constexpr double kWidth = 340.0;                              // of a frame [pixels]
constexpr double kHeight = 260.0;                             // [pixels]
const Eigen::Vector2d kReach(34.0, 26.0);                     // shown around the approach [m]
constexpr double kInteraction = 25.0;  // of centers up to which a circle is drawn [m]
constexpr const char* kFrameHeader =
    "system,scenario,seed,frame,seconds,tick,vehicle_id,role,x,y,heading,speed,circled,note\n";

/// Of the smallest distance between ego and CBVs in a summary.
std::string distanceKey() { return metrics::known::kCbvMinimumDistance.place; }

/// What a row of frames has in common with the others.
using Situation = std::array<std::string, 3>;  // scenario, seed, repetition
using RunsBySystem = std::vector<const BatchRun*>;

/// The situation to show: most systems with a CBV, then the smallest distance.
RunsBySystem chosenRuns(const std::vector<ShownSystem>& systems,
                        const std::vector<BatchRun>& runs) {
  std::map<Situation, RunsBySystem> situations;
  for (std::size_t i = 0; i < systems.size(); ++i) {
    for (const BatchRun* run : completeRuns(runs, systems[i].levels)) {
      if (!run->number(distanceKey())) continue;
      const Factors& factors = run->record.factors;
      RunsBySystem& row =
          situations[{factors.at("scenario"), factors.at("seed"), factors.at("repetition")}];
      row.resize(systems.size(), nullptr);
      if (row[i] == nullptr) row[i] = run;
    }
  }
  const auto rank = [](const RunsBySystem& row) {
    double nearest = 1e9;
    std::ptrdiff_t missing = 0;
    for (const BatchRun* run : row) {
      missing += run == nullptr;
      if (run != nullptr) nearest = std::min(nearest, *run->number(distanceKey()));
    }
    return std::make_pair(missing, nearest);
  };
  const auto best = std::min_element(
      situations.begin(), situations.end(),
      [&](const auto& left, const auto& right) { return rank(left.second) < rank(right.second); });
  return best == situations.end() ? RunsBySystem(systems.size(), nullptr) : best->second;
}

/// When and where ego and a CBV were nearest to each other.
struct Approach {
  std::uint64_t tick = 0;
  std::string vehicle;
  double distance = 1e9;  ///< of centers [m]
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
};

Approach approachOf(const std::vector<TraceRow>& rows) {
  Approach approach;
  const TraceRow* ego = nullptr;
  for (const TraceRow& row : rows) {
    if (row.role == VehicleRole::kEgo) ego = &row;
    if (row.role != VehicleRole::kCbv || ego == nullptr || ego->tick != row.tick) continue;
    const double distance = (row.position - ego->position).norm();
    if (distance < approach.distance)
      approach = {row.tick, row.id, distance, 0.5 * (row.position + ego->position)};
  }
  return approach;
}

/// Draws the frames of one run and writes their rows.
class FrameRow {
 public:
  FrameRow(const ShownSystem& system, const BatchRun& run, const session::SessionSetup* setup)
      : system_(system),
        run_(run),
        setup_(setup),
        step_(scenarioOf(run).simulation_step),
        rows_(record::readTrace(run.folder / "trace.csv")),
        approach_(approachOf(rows_)),
        canvas_({approach_.middle - kReach, approach_.middle + kReach}, {kWidth, kHeight}) {}

  std::vector<page::Panel> panels(std::string& csv) const {
    std::vector<page::Panel> panels;
    const std::uint64_t last = rows_.empty() ? 0 : rows_.back().tick;
    for (std::size_t frame = 0; frame < kOffsets.size(); ++frame) {
      const double wanted =
          std::round(kOffsets[frame] / step_) + static_cast<double>(approach_.tick);
      const auto tick = static_cast<std::uint64_t>(std::clamp(wanted, 0.0, double(last)));
      panels.push_back(panelAt(frame, tick, csv));
    }
    return panels;
  }

 private:
  page::Panel panelAt(std::size_t frame, std::uint64_t tick, std::string& csv) const {
    Markup vehicles;
    const TraceRow* ego = nullptr;
    const TraceRow* other = nullptr;
    for (const TraceRow& row : rows_) {
      if (row.tick != tick || !canvas_.shows(row.position)) continue;
      if (row.role == VehicleRole::kEgo) ego = &row;
      if (row.id == approach_.vehicle) other = &row;
      vehicles = boxOf(row) + vehicles;  // the ego comes first in the trace and lies on top
    }
    const bool circled = ego != nullptr && other != nullptr &&
                         (ego->position - other->position).norm() <= kInteraction;
    for (const TraceRow& row : rows_) {
      if (row.tick == tick && canvas_.shows(row.position))
        csv += csvOf(frame, row, circled && (&row == ego || &row == other));
    }
    page::Panel panel;
    panel.title =
        system_.name + ", " + core::formatFixed(static_cast<double>(tick) * step_, 2) + " s";
    panel.cut = true;
    panel.width = kWidth;
    panel.height = kHeight;
    panel.content = groundSvg(setup_, canvas_) + vehicles;
    if (circled) panel.content += circle(*ego, *other);
    if (frame == 0) panel.content += page::scaleBarSvg(canvas_);
    return panel;
  }

  Markup boxOf(const TraceRow& row) const {
    const traffic::VehicleDimensions size;  // the trace does not hold it
    const char* style = row.role == VehicleRole::kEgo   ? "ego"
                        : row.role == VehicleRole::kCbv ? "cbv"
                                                        : "bg";
    return page::vehicleSvg({row.id, size.length, size.width}, {row.position, row.heading}, canvas_,
                            style);
  }

  Markup circle(const TraceRow& ego, const TraceRow& other) const {
    const Eigen::Vector2d center = canvas_.toPixels(0.5 * (ego.position + other.position));
    const double radius = (0.5 * (ego.position - other.position).norm() + 3.5) * canvas_.scale();
    return page::svgCircle("interaction", center, radius) + "\n";
  }

  std::string csvOf(std::size_t frame, const TraceRow& row, bool circled) const {
    const Factors& factors = run_.record.factors;
    return core::csvRow(
        {system_.name, factors.at("scenario"), factors.at("seed"), std::to_string(frame + 1),
         core::formatFixed(static_cast<double>(row.tick) * step_, 2), std::to_string(row.tick),
         row.id, traffic::toText(row.role), core::formatNumber(row.position.x()),
         core::formatNumber(row.position.y()), core::formatNumber(row.heading),
         core::formatNumber(row.speed), circled ? "true" : "false", ""});
  }

  const ShownSystem& system_;
  const BatchRun& run_;
  const session::SessionSetup* setup_;
  double step_;
  std::vector<TraceRow> rows_;
  Approach approach_;
  page::MapCanvas canvas_;
};

/// The road is the same in all rows.
std::unique_ptr<session::SessionSetup> setupOf(const RunsBySystem& row, Figure& figure) {
  const auto run = std::find_if(row.begin(), row.end(), [](const auto* one) { return one; });
  if (run == row.end()) return nullptr;
  figure.sheet.notes.push_back(
      "Scenario " + (*run)->record.factors.at("scenario") + ", seed " +
      (*run)->record.factors.at("seed") +
      ". CBV purple, ego red, background blue; red circle: interaction of ego and CBV.");
  figure.sheet.notes.emplace_back(
      "Frames 1.5 s before, at and 1 s after the smallest distance between the centers of ego and "
      "CBV. Boxes have the default size.");
  return roadsOf(**run, figure.sheet);
}

}  // namespace

std::unique_ptr<session::SessionSetup> roadsOf(const BatchRun& run, page::PanelSheet& sheet) {
  try {
    return std::make_unique<session::SessionSetup>(scenarioOf(run));
  } catch (const core::InputError& error) {
    sheet.notes.push_back("Roads are not drawn: " + std::string(error.what()));
    return nullptr;
  }
}

Markup groundSvg(const session::SessionSetup* setup, const page::MapCanvas& canvas) {
  const Markup ground = page::svgPath("ground", "M0 0H" + core::shortNumber(canvas.width()) + "V" +
                                                    core::shortNumber(canvas.height()) + "H0Z");
  return setup == nullptr ? ground : ground + page::roadSvg(*setup, canvas);
}

Figure frameFigure(const std::string& id, const std::string& title,
                   const std::vector<ShownSystem>& systems, const std::vector<BatchRun>& runs) {
  Figure figure;
  figure.id = id;
  figure.csv = kFrameHeader;
  figure.sheet.title = title;
  const RunsBySystem row = chosenRuns(systems, runs);
  const auto setup = setupOf(row, figure);
  for (std::size_t i = 0; i < systems.size(); ++i) {
    if (row[i] != nullptr) {
      figure.sheet.rows.push_back(FrameRow(systems[i], *row[i], setup.get()).panels(figure.csv));
      continue;
    }
    const std::string reason =
        emptyReason(systems[i].levels, runs, "no CBV was driven in this scenario");
    figure.sheet.notes.push_back(systems[i].name + ": " + reason);
    std::vector<std::string> cells(14);
    cells.front() = systems[i].name;
    cells.back() = reason;
    figure.csv += core::csvRow(cells);
  }
  return figure;
}

}  // namespace cdiff::evaluation
