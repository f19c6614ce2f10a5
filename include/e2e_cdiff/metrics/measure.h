// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <string>

namespace cdiff::metrics {

/// Whether a larger value is a better session.
enum class Direction { kHigherIsBetter, kLowerIsBetter, kNeither };

/// Whose driving a measure describes.
enum class Subject { kEgo, kCbvs, kEgoAndOthers };

/// What the values of several sessions are summed up to (docs/evaluation.md).
enum class Pooling {
  kByUnit,     ///< unit "count": kCount; "1/km": kRate; "%": kShare; else kMean
  kMean,       ///< mean of the sessions' values
  kStatistic,  ///< the same, of a value that says something of a session's samples as a whole
  kCount,      ///< events: their sum over the distance driven, per km
  kRate,       ///< events per km already: value x km is their number
  kShare,      ///< percentage of samples: the percentage of all sessions' samples together
};

/// What a session weighs in such a sum.
enum class SessionWeight {
  kByKind,         ///< counts and rates: the subject's km; shares: the subject's time; else 1
  kOne,            ///< all sessions alike
  kEgoKilometres,  ///< driven by the ego
  kCbvKilometres,  ///< driven as CBV
  kCbvDecisions,   ///< decisions with a CBV
  kSeconds,        ///< simulated time
};

/// How a measure is summed up over sessions and between which values it lies, from which its
/// interval follows. The default follows from the measure's unit and subject.
struct PoolingRule {
  Pooling kind = Pooling::kByUnit;
  SessionWeight weight = SessionWeight::kByKind;
  double least = -std::numeric_limits<double>::infinity();
  double most = std::numeric_limits<double>::infinity();
};

/// Means and statistics of values that lie between 0 and 1, between 0 and 100, anywhere.
inline constexpr PoolingRule kMeanToOne = {Pooling::kMean, SessionWeight::kOne, 0.0, 1.0};
inline constexpr PoolingRule kMeanToHundred = {Pooling::kMean, SessionWeight::kOne, 0.0, 100.0};
inline constexpr PoolingRule kStatisticToOne = {Pooling::kStatistic, SessionWeight::kOne, 0.0, 1.0};
inline constexpr PoolingRule kPlainMean = {Pooling::kMean, SessionWeight::kOne};
inline constexpr PoolingRule kPlainStatistic = {Pooling::kStatistic, SessionWeight::kOne};
/// Whole events that have another unit than "count".
inline constexpr PoolingRule kEvents = {Pooling::kCount, SessionWeight::kByKind};

/// The definition of one measure. Its texts must live as long as the program: string literals.
struct MeasureDefinition {
  const char* name;   ///< snake_case, unique; of messages and batch columns
  const char* place;  ///< JSON pointer to the number in summary.json; "": /metrics/NAME/value
  const char* label;  ///< for people
  const char* unit;   ///< "s", "%", "m/s" ..., "count" for whole numbers, "" without unit
  Direction direction;
  Subject subject;
  const char* definition;    ///< sentences, source included
  const char* rift_compat;   ///< how RIFT's code differs; "" where it does not compute it otherwise
  int decimals = 3;          ///< in the report's table
  bool main = false;         ///< whether /diagnostics shows it
  PoolingRule pooling = {};  ///< how batches sum it up
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
