// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <map>
#include <string>
#include <vector>

#include "learning/task.h"
#include "planners/pluto/training/pluto_samples.h"

namespace cdiff::planners {

/// Measures the planner's own network on moments: distances of plans from where the vehicle was in
/// the 4 s to come (mean, and at their end) [m], and which plan it chooses.
class PlutoValidation {
 public:
  explicit PlutoValidation(const PlutoModel& model) : model_(model) {}
  void add(const PlutoScene& scene, const PlutoPlace& place);
  learning::Measures measures() const;

 private:
  /// Sums of distances of one kind of plan.
  struct Distances {
    double mean = 0.0;
    double end = 0.0;
  };
  PlutoNetwork& networkOf(const PlutoWorld& world);
  void addBaselines(const PlutoTarget& target, double speed);

  PlutoModel model_;
  std::map<const PlutoWorld*, PlutoNetwork> networks_;
  std::map<std::string, Distances> sums_;
  double count_ = 0.0;
  double free_ = 0.0;   ///< moments at which the free plan drives
  double right_ = 0.0;  ///< moments whose largest logit is that of the right line and mode
};

/// The measures as a Markdown table.
std::string plutoTable(const learning::Measures& held_out);

}  // namespace cdiff::planners
