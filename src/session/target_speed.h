// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <string>

#include "e2e_cdiff/core/options.h"

namespace cdiff::session {

/// How fast CBVs want to drive: all at the scenario's target_speed, or each at a speed of its own
/// from N(mean, deviation^2) cut to [lowest, highest] [m/s].
struct CbvSpeedOptions {
  std::string distribution = "fixed";  ///< fixed | normal
  double mean = 7.0;                   ///< of the normal distribution [m/s]
  double deviation = 1.8;              ///< its standard deviation before the cut [m/s]
  double lowest = 3.5;                 ///< [m/s]
  double highest = 10.5;               ///< [m/s]

  bool drawn() const { return distribution != "fixed"; }
  void describe(core::OptionsVisitor& visitor);
  /// Throws InputError for a mean outside [lowest, highest], or a range narrower than `deviation`.
  void validate() const;
};

/// v* of a CBV before the lane's limit [m/s]; `fixed` where nothing is drawn. The same for a
/// vehicle whenever it is selected, whatever others there are: a draw of the stream
/// "cbv_target_speed" of the root seed by the vehicle's id, repeated until it lies in the range.
double cbvTargetSpeed(const CbvSpeedOptions& options, double fixed, std::uint64_t seed,
                      const std::string& vehicle_id);

}  // namespace cdiff::session
