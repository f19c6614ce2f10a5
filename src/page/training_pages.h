// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "learning/samples/driving_sample.h"

namespace cdiff::page {

// Pictures of training samples as one HTML page: what the vehicle saw beside what it then did, from
// above in its own frame (meters, forward is up, route green), by kind of driving.

/// A table's row: what is counted, how often, its share.
struct CountRow {
  std::string name;
  std::string number;
  std::string share;
};

/// Indices of up to `count` samples of each kind (learning/samples/sample_order.h), evenly over the
/// data set, by name of the kind.
std::vector<std::pair<std::string, std::vector<std::size_t>>> samplesByKind(
    const learning::DrivingDataset& dataset, std::size_t count);

/// The page: `counts` and a row of pictures for each kind. Self-contained.
std::string sampleSheet(const std::string& title, const std::vector<CountRow>& counts,
                        const learning::DrivingDataset& dataset, std::size_t count);

// The course of a training as one HTML page: for each stage its loss, its held-out errors (m, m/s,
// rad, share of an action) and its speed over the seconds of training.

/// Values of one measure over time: (seconds of training, value).
using TrainingCurve = std::vector<std::pair<double, double>>;

/// One stage of `cdiff train`.
struct TrainingStage {
  std::string name;
  long steps = 0;                               ///< step of its last row
  double seconds = 0.0;                         ///< time of its last row [s]
  std::map<std::string, TrainingCurve> curves;  ///< by measure
};

/// The stages of a `curves.csv`, in order of appearance; an incomplete last row, which a kill
/// leaves, is skipped. Throws InputError naming `source` and the line of anything else that does
/// not belong in such a file.
std::vector<TrainingStage> readTrainingCurves(const std::string& text, const std::string& source);

/// The page; `card` is the text of the model card, empty if there is none yet.
std::string trainingReport(const std::string& title, const std::vector<TrainingStage>& stages,
                           const std::string& card);

}  // namespace cdiff::page
