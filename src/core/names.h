// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Names that users give to things: planners, objectives, metrics, keys.
#pragma once

#include <string_view>

namespace cdiff::core {

/// Whether `name` is a lower-case letter and then lower-case letters, digits and underscores.
inline bool isSnakeCase(std::string_view name) {
  if (name.empty() || name.front() < 'a' || name.front() > 'z') return false;
  return name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_") == std::string_view::npos;
}

}  // namespace cdiff::core
