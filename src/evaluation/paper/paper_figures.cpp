// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/paper/paper_figures.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <unordered_map>

#include "core/csv.h"
#include "core/file.h"
#include "core/text.h"
#include "evaluation/paper/bar_figure.h"
#include "evaluation/paper/execution_figure.h"
#include "evaluation/paper/frame_figure.h"
#include "evaluation/paper/paper_systems.h"
#include "evaluation/paper/paper_table.h"
#include "evaluation/paper/published_figures.h"
#include "evaluation/paper/table_definitions.h"
#include "metrics/formulas/distributions.h"
#include "page/pictures/charts.h"
#include "record/logs/driving_log.h"
#include "record/result_folder.h"

namespace cdiff::evaluation {

namespace {

/// The paper's own system without and with collision-seeking guidance by both methods, ego
/// PDM-Lite.
std::vector<ShownSystem> shownModes() {
  std::vector<ShownSystem> systems;
  for (const PaperSystem& own : {paper::kDiffusion, paper::kPaperMethod}) {
    for (const char* mode : {kNaturalistic, kSafetyCritical}) {
      systems.push_back({std::string("E2E-CDiff") + (mode == kSafetyCritical ? " w/ coll" : "") +
                             " (method " + own.method + ")",
                         merged(egoLevel(paper::kPdmLite), cbvLevels(own, mode))});
    }
  }
  return systems;
}

}  // namespace

std::vector<ShownSystem> shownCbvPlanners(const std::vector<BatchRun>& runs) {
  std::vector<ShownSystem> systems;
  std::set<std::string> further;
  Factors levels = cbvLevels(paper::kPdmLite);
  levels["ego_planner"] = paper::kPdmLite.planner();
  levels.erase("cbv_planner");
  for (const BatchRun* run : runsWith(runs, levels))
    further.insert(run->record.factors.at("cbv_planner"));
  for (const PaperSystem& system : paperCbvPlanners()) {
    systems.push_back({system.name, merged(egoLevel(paper::kPdmLite), cbvLevels(system))});
    further.erase(system.planner());
  }
  for (const std::string& planner : further) {
    systems.push_back({planner + " (not in the paper)", levels});
    systems.back().levels["cbv_planner"] = planner;
  }
  return systems;
}

std::vector<const BatchRun*> completeRuns(const std::vector<BatchRun>& runs,
                                          const Factors& levels) {
  std::vector<const BatchRun*> found = runsWith(runs, levels);
  found.erase(std::remove_if(found.begin(), found.end(),
                             [](const BatchRun* run) { return !run->record.complete(); }),
              found.end());
  return found;
}

std::size_t countSeeds(const std::vector<const BatchRun*>& runs) {
  std::set<std::string> seeds;
  for (const BatchRun* run : runs) seeds.insert(run->record.factors.at("seed"));
  return seeds.size();
}

std::vector<Figure> paperFigures(const std::vector<BatchRun>& runs) {
  Figure latency = barFigure(latencyFigure(), runs);
  latency.wall_clock = true;
  Figure planners =
      frameFigure("figure_5", "Figure 5. CBV planners from above", shownCbvPlanners(runs), runs);
  for (const std::string& line : systemDifferences({paper::kPpo, paper::kPluto, paper::kRift}))
    planners.sheet.notes.push_back(line);
  return {distributionFigure(runs),
          barFigure(collisionFigure(), runs),
          planners,
          frameFigure("figure_6", "Figure 6. Safety-critical scenario generation from above",
                      shownModes(), runs),
          executionFigure(runs),
          latency};
}

namespace {

/// One quantity of one planner.
struct Sample {
  std::vector<double> values;
  record::Histogram histogram;
  metrics::Measure w;  ///< Shapiro-Wilk
};

struct PlannerSamples {
  std::string name;
  std::string note;
  std::size_t runs = 0;
  std::size_t seeds = 0;
  Sample speeds{{}, record::Histogram(0.0, 0.5, 40), {}};
  Sample accelerations{{}, record::Histogram(-8.0, 0.5, 32), {}};
};

/// Speeds of CBVs at decisions, and d speed / d t over the tick before.
void addRun(const BatchRun& run, PlannerSamples& samples) {
  const session::ScenarioOptions options = scenarioOf(run);
  const auto ticks =
      static_cast<std::uint64_t>(std::llround(options.decision_period / options.simulation_step));
  std::unordered_map<std::string, std::pair<std::uint64_t, double>> last;  // tick and speed
  const std::vector<record::TraceRow> rows = record::readTrace(run.folder / "trace.csv");
  for (const record::TraceRow& row : rows) {
    if (row.tick == rows.back().tick) break;  // the session has ended: nothing is decided
    const auto before = last.find(row.id);
    if (row.role == traffic::VehicleRole::kCbv && row.tick % ticks == 0) {
      samples.speeds.values.push_back(row.speed);
      if (before != last.end() && before->second.first + 1 == row.tick) {
        samples.accelerations.values.push_back((row.speed - before->second.second) /
                                               options.simulation_step);
      }
    }
    last[row.id] = {row.tick, row.speed};
  }
}

void conclude(Sample& sample) {
  for (const double value : sample.values) sample.histogram.add(value);
  sample.w =
      metrics::normalityMeasures({sample.values.begin(), sample.values.end()}, "no CBV was driven")
          .w;
}

PlannerSamples samplesOf(const ShownSystem& system, const std::vector<BatchRun>& runs) {
  PlannerSamples samples;
  samples.name = system.name;
  const auto own = completeRuns(runs, system.levels);
  samples.runs = own.size();
  samples.seeds = countSeeds(own);
  for (const BatchRun* run : own) addRun(*run, samples);
  conclude(samples.speeds);
  conclude(samples.accelerations);
  if (samples.speeds.values.empty())
    samples.note = emptyReason(system.levels, runs, "no CBV was driven");
  return samples;
}

std::string rowsOf(const PlannerSamples& planner, const Sample& sample, const std::string& quantity,
                   const std::string& unit) {
  std::string text;
  const record::Histogram& histogram = sample.histogram;
  for (std::size_t bin = 0; bin < histogram.counts().size(); ++bin) {
    const double low = histogram.low() + static_cast<double>(bin) * histogram.width();
    text += core::csvRow({planner.name, quantity, unit, core::formatNumber(low),
                          core::formatNumber(low + histogram.width()),
                          std::to_string(histogram.counts()[bin]),
                          core::formatNumber(histogram.share(bin) / histogram.width()),
                          std::to_string(histogram.n()), core::csvNumber(histogram.mean()),
                          core::csvNumber(histogram.standardDeviation()),
                          core::csvNumber(sample.w.value), std::to_string(sample.w.n),
                          std::to_string(planner.runs), std::to_string(planner.seeds), ""});
  }
  return text;
}

std::string csvOf(const std::vector<PlannerSamples>& planners) {
  std::string text =
      "planner,quantity,unit,bin_low,bin_high,count,density,n,mean,std,shapiro_wilk_w,"
      "shapiro_wilk_n,runs,seeds,note\n";
  for (const PlannerSamples& planner : planners) {
    if (!planner.note.empty()) {
      text +=
          core::csvRow({planner.name, "", "", "", "", "", "", "0", "", "", "", "0",
                        std::to_string(planner.runs), std::to_string(planner.seeds), planner.note});
      continue;
    }
    text += rowsOf(planner, planner.speeds, "speed", "m/s") +
            rowsOf(planner, planner.accelerations, "acceleration", "m/s^2");
  }
  return text;
}

/// The histogram's outline as density.
std::string outline(const record::Histogram& histogram, const page::ChartAxes& axes) {
  using core::shortNumber;
  std::string data = "M" + page::svgPlace(axes.x(histogram.low()), axes.y(0.0));
  for (std::size_t bin = 0; bin < histogram.counts().size(); ++bin) {
    const double right = histogram.low() + static_cast<double>(bin + 1) * histogram.width();
    data += "V" + shortNumber(axes.y(histogram.share(bin) / histogram.width())) + "H" +
            shortNumber(axes.x(right));
  }
  return data + "V" + shortNumber(axes.y(0.0));
}

page::Panel panelOf(const std::vector<PlannerSamples>& planners, Sample PlannerSamples::*member,
                    const std::string& title, const std::string& unit) {
  const record::Histogram& shape = (planners.front().*member).histogram;
  double top = 0.1;
  for (const PlannerSamples& planner : planners) {
    const record::Histogram& histogram = (planner.*member).histogram;
    for (std::size_t bin = 0; bin < histogram.counts().size(); ++bin)
      top = std::max(top, histogram.share(bin) / histogram.width());
  }
  const double right = shape.low() + static_cast<double>(shape.counts().size()) * shape.width();
  const page::ChartAxes axes(shape.low(), right, 0.0, top);
  page::Panel panel;
  panel.title = title;
  panel.content = axes.grid(unit);
  for (std::size_t i = planners.size(); i-- > 0;) {
    const Sample& sample = planners[i].*member;
    if (sample.values.empty()) continue;
    panel.content +=
        page::svgPath("series " + page::systemStyle(i), outline(sample.histogram, axes));
  }
  return panel;
}

std::string legendText(const PlannerSamples& planner) {
  if (!planner.note.empty()) return planner.name + ": " + planner.note;
  const auto w = [](const Sample& sample) {
    return sample.w.value ? core::formatFixed(*sample.w.value, 3) : std::string("none");
  };
  return planner.name + ": n = " + std::to_string(planner.speeds.values.size()) + ", W of speed " +
         w(planner.speeds) + ", W of acceleration " + w(planner.accelerations) + " (" +
         std::to_string(planner.runs) + " runs, " + std::to_string(planner.seeds) + " seeds)";
}

}  // namespace

Figure distributionFigure(const std::vector<BatchRun>& runs) {
  std::vector<PlannerSamples> planners;
  for (const ShownSystem& system : shownCbvPlanners(runs))
    planners.push_back(samplesOf(system, runs));
  Figure figure;
  figure.id = "figure_3";
  figure.csv = csvOf(planners);
  figure.sheet.title = "Figure 3. Speed and acceleration of CBVs by planner (density)";
  for (std::size_t i = 0; i < planners.size(); ++i)
    figure.sheet.legend.emplace_back(page::systemStyle(i), legendText(planners[i]));
  figure.sheet.rows = {
      {panelOf(planners, &PlannerSamples::speeds, "Speed", "m/s"),
       panelOf(planners, &PlannerSamples::accelerations, "Acceleration", "m/s^2")}};
  figure.sheet.notes = {
      "At decisions, ego planner PDM-Lite, naturalistic; the outermost bins hold "
      "what lies beyond.",
      "RIFT's repository prints of CBVs in CARLA: speed " +
          repositoryList(paper::kPdmLite, "speed", "m/s") + "; magnitude of acceleration " +
          repositoryList(paper::kPdmLite, "acceleration", "m/s^2") +
          "; from histograms that count early samples more often."};
  for (const std::string& line : systemDifferences({paper::kPpo, paper::kPluto, paper::kRift}))
    figure.sheet.notes.push_back(line);
  return figure;
}

}  // namespace cdiff::evaluation
