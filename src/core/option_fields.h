// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <map>
#include <string>

#include "e2e_cdiff/core/options.h"

namespace cdiff::core {

namespace detail {

// The keys of an options struct with those of its groups before them: "cbv.search_radius".

/// The full key that `key` means: itself, or the one whose last part it is. Throws InputError that
/// names `source` and the nearest key, or the keys among which it is ambiguous.
std::string resolvePath(const std::string& key, const std::string& source, void* options,
                        Describe describe);

/// What can be set instead of the group `path` itself: "protocol.preset (one of {a, b}),
/// protocol.time_limit ..." and fields called after it ("guidance_profile"). Empty for a field.
std::string keysInstead(const std::string& path, void* options, Describe describe);

/// How loading, checking and dumping of options write a range of values: "[0, 10000000] m".
std::string rangeText(double low, double high, const char* unit);

void requireRanges(void* options, Describe describe, const std::string& subject);

std::map<std::string, std::string> flatten(void* options, Describe describe);

}  // namespace detail

/// The value of every field as YAML by its full key: "cbv.search_radius" -> "60".
template <class Options>
std::map<std::string, std::string> flatOptions(Options options) {
  return detail::flatten(&options, &detail::describeAs<Options>);
}

/// Holds values that were set in code against the ranges and choices of their description, which
/// loading checks by itself. Throws InputError: "SUBJECT option 'KEY' is 0; expected a number in
/// [1, 10] m".
template <class Options>
void requireRanges(Options options, const std::string& subject) {
  detail::requireRanges(&options, &detail::describeAs<Options>, subject);
}

}  // namespace cdiff::core
