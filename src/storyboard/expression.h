// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <map>
#include <string>

namespace cdiff::storyboard {

/// Values of parameters by their names, as texts.
using Parameters = std::map<std::string, std::string>;

/// The value of an attribute: "$name" is that parameter's value, "${...}" the value of an
/// expression with numbers, $names, + - * / % ( ), round, floor, ceil, sqrt, pow, min, max, abs,
/// sign, not, and, or. Every other text is itself. Throws InputError for an unknown parameter, a
/// division by zero, and what is no expression.
std::string resolved(const std::string& text, const Parameters& parameters);

}  // namespace cdiff::storyboard
