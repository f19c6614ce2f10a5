// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// What the shipped metrics say in the same words.
#pragma once

#include <string>

#include "e2e_cdiff/metrics/figure.h"

namespace cdiff::metrics {

/// Reason of every CBV figure of a session without CBVs.
inline constexpr const char* kNoCbv = "no CBV was driven";
/// Reason of the ego's figures of a session without ego.
inline constexpr const char* kNoEgo = "the ego was never seen";

/// A value of the session as a whole.
inline Measure numberMeasure(double value) { return {value, 1, {}, {}}; }
inline Measure countMeasure(std::size_t count) { return numberMeasure(static_cast<double>(count)); }
inline Measure absentMeasure(const std::string& reason) { return {std::nullopt, 0, {}, reason}; }
inline Measure measureOrReason(const std::optional<double>& value, std::size_t n,
                               const char* reason) {
  return {value, n, {}, value ? "" : reason};
}

}  // namespace cdiff::metrics
