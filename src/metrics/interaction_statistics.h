// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Times to collision [s] of the ego over a session's decision ticks: mean, deviation and minimum
/// where defined, and the share of decisions at which they are [%].
#pragma once

#include "metrics/interaction_measures.h"
#include "metrics/sample_statistics.h"
#include "metrics/tick_share.h"

namespace cdiff::metrics {

class InteractionStatistics {
 public:
  /// One decision tick with an ego; `cbv_driven`: whether there is a CBV.
  void observe(const Interaction& interaction, bool cbv_driven);
  /// Sets the fields ttc_... of `measures`.
  void write(SessionMeasures& measures) const;

 private:
  SampleStatistics all_;
  SampleStatistics cbvs_;
  SampleStatistics lon_lat_;
  TickShare all_defined_;
  TickShare cbvs_defined_;
  TickShare lon_lat_defined_;
};

}  // namespace cdiff::metrics
