// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <map>
#include <string>
#include <utility>

namespace cdiff::planning {

/// What a planner remembers of each vehicle from decision to decision, as long as it keeps the
/// vehicle at every one of them.
template <class Memory>
class VehicleMemory {
 public:
  /// That of a vehicle, for this decision and the next; make() where there is none.
  template <class Make>
  Memory& keep(const std::string& id, const Make& make) {
    auto known = known_.extract(id);
    if (!known.empty()) return kept_.insert(std::move(known)).position->second;
    const auto kept = kept_.find(id);
    return kept != kept_.end() ? kept->second : kept_.emplace(id, make()).first->second;
  }
  /// Ends the decision: vehicles that were not kept are forgotten.
  void forgetOthers() {
    known_ = std::move(kept_);
    kept_.clear();
  }
  /// Of a vehicle that was kept at the decision that ended.
  Memory& at(const std::string& id) { return known_.at(id); }

 private:
  std::map<std::string, Memory> known_;
  std::map<std::string, Memory> kept_;
};

}  // namespace cdiff::planning
