// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/tracking/tracker_tuning.h"

#include "core/csv.h"
#include "core/option_fields.h"
#include "core/text.h"

namespace cdiff::evaluation {
namespace {

core::RandomStream streamOf(const TuningOptions& options, const char* name) {
  return {static_cast<std::uint64_t>(options.seed), name};
}

/// Flags are 0 or 1.
void assign(const TunedKey& key, double value, planning::PlanTrackerOptions& options) {
  const bool flag = key.key == "steer_while_braking";
  const std::string text = flag ? (value > 0.0 ? "true" : "false") : core::formatNumber(value);
  core::overrideOption(key.key + "=" + text, "tuning", options);
}

/// Limits out of order.
bool possible(const planning::PlanTrackerOptions& options) {
  return options.look_ahead_minimum <= options.look_ahead_maximum;
}

}  // namespace

TuningTracks::TuningTracks(const TuningOptions& options)
    : random(streamOf(options, "tracker plans")),
      tuning(drawTracks(streamOf(options, "tuning tracks"), options.each)),
      held_out(drawTracks(streamOf(options, "held-out tracks"), options.each)) {}

const std::vector<TunedKey>& tunedKeys() {
  static const std::vector<TunedKey> keys = {
      {"aim_period", {0.1, 0.2, 0.5, 1.0}},
      {"steer_while_braking", {0.0, 1.0}},
      {"look_ahead_time", {0.0, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8}},
      {"look_ahead_distance", {0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0}},
      {"look_ahead_minimum", {2.0, 2.5, 3.0, 3.5, 4.0, 4.5, 5.0}},
      {"look_ahead_maximum", {5.0, 6.0, 7.0, 8.0, 10.0}},
      {"turn_kp", {0.75, 1.0, 1.25, 1.5, 1.75, 2.0, 2.5}},
      {"turn_ki", {0.0, 0.25, 0.5, 0.75, 1.0}},
      {"turn_kd", {0.0, 0.1, 0.2, 0.3, 0.5, 0.75}},
      {"speed_horizon", {1.0, 2.0, 3.0, 8.0}}};
  return keys;
}

std::string valueLine(const TunedKey& key, const planning::PlanTrackerOptions& options) {
  return key.key + ": " + core::flatOptions(options).at(key.key) + "\n";
}

planning::PlanTrackerOptions tuneTracker(const TuningTracks& tracks,
                                         const dynamics::BicycleModel& model) {
  const auto costOf = [&](const planning::PlanTrackerOptions& options) {
    return drive(tracks.tuning, planTracker("", options), model, tracks.random).cost();
  };
  auto best = planning::PlanTrackerOptions::published();
  double least = costOf(best);
  for (bool changed = true; changed;) {
    changed = false;
    for (const TunedKey& key : tunedKeys()) {
      const planning::PlanTrackerOptions before = best;
      for (const double value : key.values) {
        planning::PlanTrackerOptions tried = before;
        assign(key, value, tried);
        const double cost = possible(tried) ? costOf(tried) : least;
        if (cost >= least) continue;
        least = cost;
        best = tried;
        changed = true;
      }
    }
  }
  return best;
}

TrackerRow evaluateTracker(const NamedTracker& tracker, const TuningTracks& tracks,
                           const dynamics::BicycleModel& model) {
  TrackerRow row;
  row.name = tracker.name;
  row.tuning = drive(tracks.tuning, tracker, model, tracks.random);
  row.held_out = drive(tracks.held_out, tracker, model, tracks.random);
  for (const std::string& kind : trackKinds())
    row.by_kind.push_back(drive(ofKind(tracks.held_out, kind), tracker, model, tracks.random));
  return row;
}

namespace {

std::vector<std::string> cellsOf(const TrackingMeasures& measures) {
  constexpr int kDigits = 3;
  std::vector<std::string> cells;
  for (const double value :
       {measures.lateral, measures.largest_lateral, measures.off_road_percent,
        measures.steer_change, measures.speed_error, measures.unfinished_percent, measures.cost()})
    cells.push_back(core::formatFixed(value, kDigits));
  return cells;
}

std::string markdownRow(std::vector<std::string> head, const TrackingMeasures& measures) {
  for (const std::string& cell : cellsOf(measures)) head.push_back(cell);
  return "| " + core::joinText(head, " | ") + " |\n";
}

std::string csvLine(const std::vector<std::string>& head, const TrackingMeasures& measures) {
  std::vector<std::string> cells = head;
  for (const std::string& cell : cellsOf(measures)) cells.push_back(cell);
  cells.push_back(std::to_string(measures.decisions));
  return core::csvRow(cells);
}

}  // namespace

std::string tuningTable(const std::vector<TrackerRow>& rows) {
  std::string text =
      "| Tracker | Tracks | off the line, m | at most, m | corner off the lane, % | change of "
      "steer "
      "| speed error, m/s | tracks not finished, % | cost "
      "|\n|---|---|---|---|---|---|---|---|---|\n";
  for (const TrackerRow& row : rows) {
    text += markdownRow({row.name, "tuning"}, row.tuning);
    text += markdownRow({row.name, "held out"}, row.held_out);
  }
  text += "\n| Tracker | ... % of decisions on held-out tracks | " +
          core::joinText(trackKinds(), " | ") + " |\n|---|---|---|---|---|---|---|\n";
  for (const TrackerRow& row : rows) {
    text += "| " + row.name + " | corner off the lane";
    for (const TrackingMeasures& kind : row.by_kind)
      text += " | " + core::formatFixed(kind.off_road_percent, 1);
    text += " |\n";
  }
  return text;
}

std::string tuningCsv(const std::vector<TrackerRow>& rows) {
  std::string text =
      "tracker,tracks,kind,lateral_m,largest_lateral_m,off_road_percent,steer_change,"
      "speed_error_mps,unfinished_percent,cost,decisions\n";
  for (const TrackerRow& row : rows) {
    text += csvLine({row.name, "tuning", "all"}, row.tuning);
    text += csvLine({row.name, "held_out", "all"}, row.held_out);
    for (std::size_t i = 0; i < row.by_kind.size(); ++i)
      text += csvLine({row.name, "held_out", trackKinds()[i]}, row.by_kind[i]);
  }
  return text;
}

}  // namespace cdiff::evaluation
