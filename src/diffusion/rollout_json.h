// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Matrices of a rollout's shape, [T, 7] (columns of traffic::Rollout: m, rad, m/s, pedals), as the
/// JSON text that a normalizer and the spread have in weight files and checkpoints.
#pragma once

#include <string>

#include "e2e_cdiff/traffic/rollout.h"
#include "inference/strict_json.h"

namespace cdiff::diffusion {

/// [[...], ...] with the shortest numbers that read back to the same double.
std::string rolloutText(const traffic::Rollout& matrix);

/// A [rows, 7] matrix of numbers. Throws InputError that begins with `where`.
traffic::Rollout rolloutOf(const inference::Json& value, std::int64_t rows,
                           const std::string& where);

}  // namespace cdiff::diffusion
