// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>

#include "e2e_cdiff/core/options.h"

namespace cdiff::core {

namespace detail {
void requireRanges(void* options, Describe describe, const std::string& subject);
}  // namespace detail

/// Holds values that were set in code against the ranges and choices of their description, which
/// loading checks by itself. Throws InputError: "SUBJECT option 'KEY' is 0; expected a number in
/// [1, 10] m".
template <class Options>
void requireRanges(Options options, const std::string& subject) {
  detail::requireRanges(&options, &detail::describeAs<Options>, subject);
}

}  // namespace cdiff::core
