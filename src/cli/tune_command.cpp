// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The command `cdiff tune`: tunes the tracker of plans on drawn tracks, compares trackers.
#include <iostream>
#include <memory>

#include "cli/commands.h"
#include "core/file.h"
#include "evaluation/tracking/tracker_tuning.h"

namespace cdiff::cli {
namespace {

struct TuneArguments {
  evaluation::TuningOptions options;
  std::string csv;
};

std::string verdictOf(const planning::PlanTrackerOptions& found) {
  planning::PlanTrackerOptions known = found;
  known.tracker = planning::kTunedTracker;
  return core::dumpOptions(known) == core::dumpOptions(planning::PlanTrackerOptions())
             ? "these are the values of tracker 'tuned'\n"
             : "tracker 'tuned' has other values (the row above is of those found)\n";
}

void tune(const TuneArguments& arguments) {
  const evaluation::TuningTracks tracks(arguments.options);
  const dynamics::BicycleModel model;
  const planning::PlanTrackerOptions found = evaluation::tuneTracker(tracks, model);
  std::vector<evaluation::TrackerRow> rows;
  for (const evaluation::NamedTracker& tracker :
       {evaluation::planTracker("published", planning::PlanTrackerOptions::published()),
        evaluation::planTracker("tuned", {}), evaluation::planTracker("found here", found),
        evaluation::pdmLiteTracker()})
    rows.push_back(evaluation::evaluateTracker(tracker, tracks, model));
  std::cout << evaluation::tuningTable(rows) << "\nfound:\n";
  for (const evaluation::TunedKey& key : evaluation::tunedKeys())
    std::cout << evaluation::valueLine(key, found);
  std::cout << verdictOf(found);
  if (!arguments.csv.empty()) core::writeFileAtomically(arguments.csv, evaluation::tuningCsv(rows));
}

}  // namespace

void addTuneCommand(CLI::App& program, int& exit_code) {
  auto arguments = std::make_shared<TuneArguments>();
  CLI::App* command = program.add_subcommand(
      "tune", "Tune the tracker of plans on drawn tracks and compare trackers");
  command->add_option("--seed", arguments->options.seed, "Root seed of tracks and plans")
      ->capture_default_str()
      ->check(CLI::Range(0, 2147483647));
  command->add_option("--tracks", arguments->options.each, "Tracks of each kind")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000));
  command->add_option("--csv", arguments->csv, "File for the table with all kinds of tracks");
  command->callback([arguments, &exit_code] {
    tune(*arguments);
    exit_code = ExitCode::kPassed;
  });
}

}  // namespace cdiff::cli
