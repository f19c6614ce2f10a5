// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/paper/execution_figure.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <optional>

#include "core/csv.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "evaluation/paper/frame_figure.h"
#include "evaluation/paper/paper_figures.h"
#include "evaluation/paper/paper_systems.h"
#include "evaluation/paper/paper_table.h"
#include "page/pictures/charts.h"
#include "page/pictures/map_canvas.h"
#include "page/pictures/top_view.h"
#include "record/logs/plan_log.h"

namespace cdiff::evaluation {
namespace {

using record::PlanRow;

constexpr const char* kExecutionHeader =
    "part,execution,scenario,seed,vehicle_id,tick,seconds,displacement_mean_m,displacement_p95_m,"
    "speed_difference_mean_mps,decisions,runs,seeds,planned_x,planned_y,planned_speed,driven_x,"
    "driven_y,driven_speed,note\n";
constexpr std::size_t kColumns = 20;

using Plan = std::vector<PlanRow>;  // rows of one decision

/// Plans whose whole horizon was driven.
std::vector<Plan> drivenPlans(const std::vector<PlanRow>& rows) {
  std::vector<Plan> plans;
  for (const PlanRow& row : rows) {
    if (row.seconds == 0.0) plans.emplace_back();
    if (!plans.empty()) plans.back().push_back(row);
  }
  plans.erase(
      std::remove_if(plans.begin(), plans.end(),
                     [](const Plan& plan) { return plan.size() < 2 || !plan.back().driven; }),
      plans.end());
  return plans;
}

double displacement(const PlanRow& row) {
  return (row.planned.position - row.driven->position).norm();
}

/// One kind of execution over all its runs.
struct Execution {
  std::string name;
  std::string note;
  std::size_t runs = 0;
  std::size_t seeds = 0;
  std::map<double, std::vector<double>> displacements;      ///< by seconds since the decision [m]
  std::map<double, std::vector<double>> speed_differences;  ///< [m/s]
  std::map<std::pair<std::string, std::string>, std::vector<Plan>> plans;  ///< by scenario, seed
  std::map<std::pair<std::string, std::string>, const BatchRun*> run_of;
};

Execution executionOf(const ShownSystem& system, const std::vector<BatchRun>& runs) {
  Execution execution;
  execution.name = system.name;
  const auto own = completeRuns(runs, system.levels);
  execution.runs = own.size();
  execution.seeds = countSeeds(own);
  for (const BatchRun* run : own) {
    if (!std::filesystem::exists(run->folder / "plans.csv")) continue;
    const std::vector<PlanRow> rows = record::readPlans(run->folder / "plans.csv");
    for (const PlanRow& row : rows) {
      if (!row.driven) continue;
      execution.displacements[row.seconds].push_back(displacement(row));
      execution.speed_differences[row.seconds].push_back(
          std::abs(row.planned.speed - row.driven->speed));
    }
    const std::pair key(run->record.factors.at("scenario"), run->record.factors.at("seed"));
    if (execution.run_of.emplace(key, run).second) execution.plans[key] = drivenPlans(rows);
  }
  if (execution.displacements.empty())
    execution.note = emptyReason(system.levels, runs, "no plan of a CBV was driven");
  return execution;
}

std::string curveRows(const Execution& execution) {
  std::string text;
  for (const auto& [seconds, values] : execution.displacements) {
    const record::SampleSummary summary = record::summaryOf(values);
    std::vector<std::string> cells(kColumns);
    cells[0] = "horizon";
    cells[1] = execution.name;
    cells[6] = core::formatNumber(seconds);
    cells[7] = core::formatNumber(*summary.mean);
    cells[8] = core::formatNumber(*summary.percentile_95);
    cells[9] = core::formatNumber(*record::summaryOf(execution.speed_differences.at(seconds)).mean);
    cells[10] = std::to_string(summary.n);
    cells[11] = std::to_string(execution.runs);
    cells[12] = std::to_string(execution.seeds);
    text += core::csvRow(cells);
  }
  if (!execution.note.empty()) {
    std::vector<std::string> cells(kColumns);
    cells[0] = "horizon";
    cells[1] = execution.name;
    cells.back() = execution.note;
    text += core::csvRow(cells);
  }
  return text;
}

page::Panel curves(const std::vector<Execution>& executions,
                   std::map<double, std::vector<double>> Execution::*member,
                   const std::string& title, const std::string& unit) {
  double top = 0.5;
  double right = 1.0;
  for (const Execution& execution : executions) {
    for (const auto& [seconds, values] : execution.*member) {
      top = std::max(top, *record::summaryOf(values).mean);
      right = std::max(right, seconds);
    }
  }
  const page::ChartAxes axes(0.0, right, 0.0, top);
  page::Panel panel;
  panel.title = title + " [" + unit + "]";
  panel.content = axes.grid("s");
  for (std::size_t i = 0; i < executions.size(); ++i) {
    std::string data;
    for (const auto& [seconds, values] : executions[i].*member) {
      data += (data.empty() ? "M" : "L") +
              page::svgPlace(axes.x(seconds), axes.y(*record::summaryOf(values).mean));
    }
    panel.content += page::svgPath("series " + page::systemStyle(i), data);
  }
  return panel;
}

/// The plan whose displacement at the end is the median of all of a run; the lower one of two.
const Plan& medianPlan(std::vector<Plan>& plans) {
  std::sort(plans.begin(), plans.end(), [](const Plan& left, const Plan& right) {
    return displacement(left.back()) < displacement(right.back());
  });
  return plans[(plans.size() - 1) / 2];
}

std::string exampleRows(const Execution& execution, const BatchRun& run, const Plan& plan) {
  std::string text;
  for (const PlanRow& row : plan) {
    std::vector<std::string> cells(kColumns);
    cells[0] = "example";
    cells[1] = execution.name;
    cells[2] = run.record.factors.at("scenario");
    cells[3] = run.record.factors.at("seed");
    cells[4] = row.vehicle_id;
    cells[5] = std::to_string(row.tick);
    cells[6] = core::formatNumber(row.seconds);
    std::size_t column = 13;
    for (const record::Waypoint& point : {row.planned, *row.driven}) {
      for (const double value : {point.position.x(), point.position.y(), point.speed})
        cells[column++] = core::formatNumber(value);
    }
    text += core::csvRow(cells);
  }
  return text;
}

page::Panel examplePanel(const Execution& execution, const Plan& plan,
                         const session::SessionSetup* setup) {
  page::Panel panel;
  panel.height = 220.0;
  panel.cut = true;
  page::Points planned;
  page::Points driven;
  page::Region region{plan.front().planned.position, plan.front().planned.position};
  for (const PlanRow& row : plan) {
    planned.push_back(row.planned.position);
    driven.push_back(row.driven->position);
    for (const Eigen::Vector2d& point : {planned.back(), driven.back()}) {
      region.low = region.low.cwiseMin(point);
      region.high = region.high.cwiseMax(point);
    }
  }
  const page::MapCanvas canvas(region.grown(6.0), {panel.width, panel.height});
  const traffic::VehicleDimensions size;  // the plans do not hold it
  const record::Waypoint& start = plan.front().planned;
  panel.title = execution.name + ": " + core::formatFixed(displacement(plan.back()), 2) +
                " m apart after " + core::formatFixed(plan.back().seconds, 1) + " s";
  panel.content = groundSvg(setup, canvas) +
                  page::vehicleSvg({plan.front().vehicle_id, size.length, size.width},
                                   {start.position, start.heading}, canvas, "cbv") +
                  page::svgPath("driven", canvas.line(driven)) +
                  page::svgPath("plan", canvas.line(planned)) + page::scaleBarSvg(canvas);
  return panel;
}

using ScenarioAndSeed = std::pair<std::string, std::string>;

/// The scenario and seed with most driven plans of every execution that has any; none where they
/// share none.
std::optional<ScenarioAndSeed> sharedRun(const std::vector<Execution>& executions) {
  std::map<ScenarioAndSeed, std::vector<std::size_t>> counts;
  std::size_t with_plans = 0;
  for (const Execution& execution : executions) {
    if (!execution.plans.empty()) ++with_plans;
    for (const auto& [key, plans] : execution.plans) counts[key].push_back(plans.size());
  }
  std::optional<ScenarioAndSeed> best;
  std::size_t most = 0;
  for (const auto& [key, sizes] : counts) {
    const std::size_t least = *std::min_element(sizes.begin(), sizes.end());
    if (with_plans < 2 || sizes.size() < with_plans || least <= most) continue;
    most = least;
    best = key;
  }
  return best;
}

/// One decision of each execution from the run that they share.
void addExamples(std::vector<Execution>& executions, Figure& figure) {
  const auto best = sharedRun(executions);
  if (!best) return;
  executions.erase(std::remove_if(executions.begin(), executions.end(),
                                  [](const Execution& one) { return one.plans.empty(); }),
                   executions.end());
  const auto setup = roadsOf(*executions[0].run_of.at(*best), figure.sheet);
  for (std::size_t i = 0; i < executions.size(); ++i) {
    Execution& execution = executions[i];
    const Plan& plan = medianPlan(execution.plans.at(*best));
    figure.csv += exampleRows(execution, *execution.run_of.at(*best), plan);
    if (i % 2 == 0) figure.sheet.rows.emplace_back();
    figure.sheet.rows.back().push_back(examplePanel(execution, plan, setup.get()));
  }
  figure.sheet.notes.push_back(
      "Below: one decision each (scenario " + best->first + ", seed " + best->second +
      "), the one with the median displacement; dashed: planned, solid: driven.");
}

/// Of CBVs in naturalistic runs with ego PDM-Lite.
std::vector<Execution> executionsOf(const std::vector<BatchRun>& runs) {
  std::vector<Execution> executions;
  for (const PaperSystem& system : paperExecutions()) {
    const Factors levels = merged(egoLevel(paper::kPdmLite), cbvLevels(system));
    executions.push_back(executionOf({system.name, levels}, runs));
  }
  return executions;
}

}  // namespace

Figure executionFigure(const std::vector<BatchRun>& runs) {
  Figure figure;
  figure.id = "figure_7";
  figure.csv = kExecutionHeader;
  figure.sheet.title = "Figure 7. Planned against executed states of CBVs";
  std::vector<Execution> executions = executionsOf(runs);
  for (std::size_t i = 0; i < executions.size(); ++i) {
    const Execution& execution = executions[i];
    figure.csv += curveRows(execution);
    figure.sheet.legend.emplace_back(
        page::systemStyle(i),
        execution.name + ": " +
            (execution.note.empty() ? std::to_string(execution.displacements.at(0.0).size()) +
                                          " decisions, " + std::to_string(execution.runs) + " runs"
                                    : execution.note));
  }
  figure.sheet.rows = {
      {curves(executions, &Execution::displacements, "Mean distance, planned to driven", "m"),
       curves(executions, &Execution::speed_differences, "Mean speed difference", "m/s")}};
  addExamples(executions, figure);
  figure.sheet.notes.emplace_back(
      "Every decision counts that was driven that far, later decisions may change the plan.");
  return figure;
}

}  // namespace cdiff::evaluation
