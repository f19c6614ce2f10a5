// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Who is driven besides the ego, and along which route: CBV identification in a session, anybody
/// near the ego where data are collected.
#pragma once

#include "e2e_cdiff/cbv/cbv_selection.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"

namespace cdiff::cbv {

/// One per session; called once per tick in order: `update` at decision ticks, `observe` at all
/// others.
class VehicleSelector {
 public:
  virtual ~VehicleSelector() = default;
  /// A tick without decision.
  virtual void observe(const traffic::TrafficSnapshot& snapshot) = 0;
  /// The selection of this decision.
  virtual CbvSelection update(const traffic::TrafficSnapshot& snapshot) = 0;
};

}  // namespace cdiff::cbv
