// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>
#include <vector>

namespace cdiff::evaluation {

/// The five measures that answer "which is harder, which is better?": contacts of CBVs with the
/// ego, contacts at the ego's fault (both per km), driving score, route completion [%], off-road
/// rate of CBVs [%]. They are fixed here, so that a comparison corrects for five and no one chooses
/// afterward. Names as in measureNames().
const std::vector<std::string>& headlineMeasures();

/// Whether `measure` is one of them.
bool isHeadline(const std::string& measure);

}  // namespace cdiff::evaluation
