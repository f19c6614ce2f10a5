// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <memory>
#include <vector>

#include "cbv/cbv_selector.h"

namespace cdiff::realism {

/// Another selector up to its first hand-over; from there on only the vehicles of that hand-over
/// stay selected, as long as the other selector keeps them.
class HandOverSelector : public cbv::VehicleSelector {
 public:
  /// `hands_over` false: the first hand-over is noted, but not made.
  HandOverSelector(std::unique_ptr<cbv::VehicleSelector> inner, bool hands_over);

  void observe(const traffic::TrafficSnapshot& snapshot) override { inner_->observe(snapshot); }
  cbv::CbvSelection update(const traffic::TrafficSnapshot& snapshot) override;
  /// Assignments of the first hand-over; empty before.
  const std::vector<cbv::CbvAssignment>& first() const { return first_; }

 private:
  bool isFirst(const std::string& vehicle_id) const;

  std::unique_ptr<cbv::VehicleSelector> inner_;
  bool hands_over_;
  std::vector<cbv::CbvAssignment> first_;
};

}  // namespace cdiff::realism
