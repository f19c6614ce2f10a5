// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace cdiff::map {

/// Drops the vehicle classes that SUMO 1.15 does not know from the permissions of a network text;
/// all other bytes stay.
struct PermissionRewrite {
  std::string text;
  std::vector<std::string>
      removed;  ///< classes found, in a fixed order; empty when the text is unchanged
  std::size_t attributes = 0;  ///< attributes that were changed
};

/// An `allow` that becomes empty turns into disallow="all" (an empty one would allow everything); a
/// `disallow` that becomes empty goes away.
PermissionRewrite dropUnknownClasses(std::string_view text);

}  // namespace cdiff::map
