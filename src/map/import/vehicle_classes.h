// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace cdiff::map {

/// A network text without the vehicle classes that SUMO 1.15 does not know, made by
/// dropUnknownClasses; all other bytes are as before.
struct PermissionRewrite {
  std::string text;
  std::vector<std::string>
      removed;  ///< classes found, in a fixed order; empty when the text is unchanged
  std::size_t attributes = 0;  ///< attributes that were changed
};

/// Removes unknown classes from the attributes `allow` and `disallow`. An `allow` left empty is
/// replaced by disallow="all" (empty, it would allow everything); a `disallow` left empty is
/// removed.
PermissionRewrite dropUnknownClasses(std::string_view text);

}  // namespace cdiff::map
