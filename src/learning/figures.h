// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// What is recorded of a training: figures by name.
#pragma once

#include <map>
#include <string>

namespace cdiff::learning {

/// Names and values; the unit is in the name.
using Figures = std::map<std::string, double>;

}  // namespace cdiff::learning
