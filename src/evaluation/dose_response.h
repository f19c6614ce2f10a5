// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "evaluation/intervals/pooled_estimate.h"
#include "evaluation/run_record.h"

namespace cdiff::evaluation {

// How a measure follows the size of a setting. The variants of a matrix that are named AXIS_NUMBER,
// as target_speed_3 and target_speed_5.5, are the doses of one axis.

/// One setting of an axis.
struct Dose {
  double dose = 0.0;        ///< the number in the variant's name
  PooledEstimate response;  ///< over the complete runs of this variant
};

/// One axis and one measure.
struct DoseResponse {
  std::string axis;
  std::string measure;
  std::size_t routes = 0;   ///< driven at every dose
  std::vector<Dose> doses;  ///< in ascending order; at least three
  /// Rank correlation of doses and pooled responses; nullopt where all responses are equal or one
  /// is unknown.
  std::optional<double> rank_correlation;
  std::optional<Interval> interval;  ///< bootstrap by routes, the same routes at every dose
};

/// Each axis with each measure, in the order of the records and of `measures`. Only routes that are
/// complete at every dose count. Throws InputError for runs of several systems, for an unknown
/// measure and where no axis has three doses.
std::vector<DoseResponse> doseResponses(const std::vector<RunRecord>& records,
                                        const std::vector<std::string>& measures);

/// A table for people: a row for each dose, and the rank correlation of each measure.
std::string doseMarkdown(const std::vector<DoseResponse>& responses);

}  // namespace cdiff::evaluation
