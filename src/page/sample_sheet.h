// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "learning/samples/driving_sample.h"

namespace cdiff::page {

// Pictures of training samples as one HTML page: what the vehicle saw beside what it then did,
// from above in its own frame (meters, forward is up, route green), by kind of driving.

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

}  // namespace cdiff::page
