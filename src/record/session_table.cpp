// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "record/session_table.h"

#include "core/text.h"
#include "metrics/known_figures.h"

namespace cdiff::record {
namespace {

constexpr std::size_t kNameWidth = 24;

std::string row(const std::string& name, const std::string& value) {
  std::string text = "  " + name;
  text.resize(std::max(text.size() + 1, kNameWidth + 2), ' ');
  return text + value + "\n";
}

std::string headRows(const SessionResult& result) {
  const session::ScenarioOptions& options = result.setup.options();
  std::string time = core::formatFixed(result.simulated_seconds, 2) + " s simulated in " +
                     core::formatFixed(result.wall_seconds, 2) + " s";
  if (result.wall_seconds > 0.0) {
    time += " (" + core::formatFixed(result.simulated_seconds / result.wall_seconds, 1) +
            " times real time)";
  }
  return row("scenario",
             options.name + ", seed " + std::to_string(options.seed) + ", " + options.mode) +
         row("planners", "ego " + options.ego_planner + ", CBV " + options.cbv_planner) +
         row("status", traffic::toText(result.status)) + row("time", time);
}

std::string figureRows(const metrics::SessionMeasures& measures) {
  namespace figures = metrics::figures;
  const auto count = [&](const metrics::FigureDefinition& figure) {
    return std::to_string(measures.count(figure));
  };
  const auto text = [&](const metrics::FigureDefinition& figure) {
    return measureText(measures.at(figure), 2);
  };
  const auto fixed = [&](const metrics::FigureDefinition& figure) {
    return core::formatFixed(measures.number(figure), 1);
  };
  return row("route completion", fixed(figures::kRouteCompletion) + " %") +
         row("driving score", fixed(figures::kDrivingScore) + " by " + measures.protocol +
                                  ", penalty " + measureText(measures.at(figures::kPenalty), 3)) +
         row("ego collisions", count(figures::kEgoCollisions)) +
         row("CBVs",
             count(figures::kCbvCount) + " over " + count(figures::kCbvDecisions) + " decisions") +
         row("CBV collisions", count(figures::kCbvCollisions) + " (" +
                                   count(figures::kCbvEgoCollisions) + " with the ego)") +
         row("CBV off-road rate", text(figures::kCbvOffRoad)) +
         row("collisions per km", text(figures::kCollisionsPerKm)) +
         row("2D-TTC mean", text(figures::kTtcMean)) +
         row("2D-TTC minimum", text(figures::kTtcMinimum));
}

/// Wall time from image (or snapshot) to command.
std::string latencyRows(const std::map<std::string, LatencyFigures>& latencies) {
  std::string text;
  for (const auto& [planner, figures] : latencies) {
    text += row("latency " + planner, "p50 " + core::formatFixed(figures.median, 1) + " ms, p95 " +
                                          core::formatFixed(figures.percentile_95, 1) +
                                          " ms (n = " + std::to_string(figures.n) + ")");
  }
  return text;
}

}  // namespace

std::string measureText(const metrics::Measure& measure, int decimals) {
  if (!measure.value) {
    return "not defined" + (measure.reason.empty() ? std::string() : ": " + measure.reason);
  }
  return core::formatFixed(*measure.value, decimals) +
         (measure.unit.empty() ? "" : " " + measure.unit) + " (n = " + std::to_string(measure.n) +
         ")";
}

std::string sessionTable(const SessionResult& result, const std::filesystem::path& folder) {
  std::string text = headRows(result) + figureRows(result.measures) + latencyRows(result.latencies);
  const std::string late = latenessText(result.late);
  if (!late.empty()) text += row("late answers", late);
  if (!result.faults.empty()) text += row("faults", std::to_string(result.faults.size()));
  text += row("verdict", capitalsOf(result.verdict.outcome));
  for (const std::string& reason : result.verdict.reasons) text += row("", "- " + reason);
  return text + row("report", (folder / "report.html").string()) + row("results", folder.string());
}

std::string fileRow(const std::string& name, const std::filesystem::path& file) {
  std::error_code ignored;
  return std::filesystem::exists(file, ignored) ? row(name, file.string()) : "";
}

}  // namespace cdiff::record
