// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The one table of a session's figures: name, place in summary.json, unit, direction, definition
/// with source, and where RIFT's code computes it otherwise. Summary, message, report, batch
/// columns and docs/metrics.md all take it from here.
#pragma once

#include <string>
#include <vector>

#include "metrics/session_measures.h"

namespace cdiff::metrics {

/// Whether a larger value is a better session.
enum class Direction { kHigherIsBetter, kLowerIsBetter, kNeither };

/// "higher is better", "lower is better" or "no direction".
const char* toText(Direction direction);

struct FigureDefinition {
  const char* name;   ///< snake_case, unique; of messages and batch columns
  const char* place;  ///< JSON pointer to the number in summary.json
  const char* label;  ///< for people
  const char* unit;   ///< "s", "%", "m/s" ..., "count" for whole numbers, "" without unit
  Direction direction;
  const char* definition;   ///< sentences, source included
  const char* rift_compat;  ///< how RIFT's code differs; "" where it does not compute it otherwise
  Measure (*measure)(const SessionMeasures&);  ///< its value in a session
};

/// All figures in the order of summary.json: ego, CBVs, metrics, RIFT's.
const std::vector<FigureDefinition>& figureDefinitions();
/// nullptr for an unknown name.
const FigureDefinition* findFigure(const std::string& name);

}  // namespace cdiff::metrics
