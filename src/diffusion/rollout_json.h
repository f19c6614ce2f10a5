// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Matrices of a row per rollout step, [T, 7], as JSON text in files of weights.
#pragma once

#include <string>

#include "e2e_cdiff/traffic/rollout.h"
#include "strict_json.h"

namespace cdiff::diffusion {

/// [[...], ...] with the shortest numbers that read back to the same double.
std::string rolloutText(const traffic::Rollout& matrix);

/// A [rows, 7] matrix of numbers. Throws InputError that begins with `where`.
traffic::Rollout rolloutOf(const Json& value, std::int64_t rows, const std::string& where);

}  // namespace cdiff::diffusion
