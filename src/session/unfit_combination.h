// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::session {

/// Keys that are right one by one, but not together: an attack by a planner that cannot be guided.
/// A batch leaves such runs of a product of lists out.
class UnfitCombination : public core::InputError {
 public:
  using core::InputError::InputError;
};

}  // namespace cdiff::session
