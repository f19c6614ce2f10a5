// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>
#include <vector>

#include "e2e_cdiff/core/options.h"

namespace cdiff::metrics {

/// What a scenario says about its metrics (group `metrics`): the speeds [m/s] that the speeds of
/// CBVs are compared with.
struct MetricsOptions {
  std::string speed_target = "background";  ///< background | normal | file
  double speed_target_mean = 8.0;           ///< mean of the normal distribution of speeds [m/s]
  double speed_target_deviation = 2.0;      ///< standard deviation of that distribution [m/s]
  std::string speed_target_file;            ///< speeds [m/s], one a line, or JSON
  /// Content of the file as texts; filled when the scenario is resolved, so that a recording needs
  /// no file.
  std::vector<std::string> speed_target_samples;

  void describe(core::OptionsVisitor& visitor);
  /// Throws InputError for a file target without file or samples, and for a sample that is no
  /// finite number.
  void validate() const;
  /// speed_target_samples as numbers [m/s].
  std::vector<double> samples() const;
};

}  // namespace cdiff::metrics
