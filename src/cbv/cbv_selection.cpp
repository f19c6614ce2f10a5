// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/cbv/cbv_selection.h"

#include <algorithm>

namespace cdiff::cbv {

const CbvAssignment* CbvSelection::find(int slot) const {
  const auto found = std::find_if(assignments.begin(), assignments.end(),
                                  [&](const auto& assignment) { return assignment.slot == slot; });
  return found == assignments.end() ? nullptr : &*found;
}

}  // namespace cdiff::cbv
