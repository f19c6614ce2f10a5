// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstddef>
#include <optional>
#include <string>

namespace cdiff::metrics {

/// Whether a larger value is a better session.
enum class Direction { kHigherIsBetter, kLowerIsBetter, kNeither };

/// Whose driving a measure describes.
enum class Subject { kEgo, kCbvs, kEgoAndOthers };

/// The definition of one measure. Its texts must live as long as the program: string literals.
struct MeasureDefinition {
  const char* name;   ///< snake_case, unique; of messages and batch columns
  const char* place;  ///< JSON pointer to the number in summary.json; "": /metrics/NAME/value
  const char* label;  ///< for people
  const char* unit;   ///< "s", "%", "m/s" ..., "count" for whole numbers, "" without unit
  Direction direction;
  Subject subject;
  const char* definition;   ///< sentences, source included
  const char* rift_compat;  ///< how RIFT's code differs; "" where it does not compute it otherwise
  int decimals = 3;         ///< in the report's table
  bool main = false;        ///< whether /diagnostics shows it
};

/// What a session has for a measure.
struct Measure {
  std::optional<double> value;  ///< absent when n is too small or the measure is undefined
  std::size_t n = 0;            ///< samples it stands on
  std::string unit;             ///< the definition's unit, which the sink fills in
  std::string reason;  ///< why the value is absent, or how its samples were thinned out; else empty
  std::string target = {};  ///< what the samples are compared with; empty where with nothing
};

}  // namespace cdiff::metrics
