// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "metrics/pooling.h"

#include <algorithm>
#include <cmath>

#include "core/text.h"

namespace cdiff::metrics {
namespace {

Pooling kindOf(const MeasureDefinition& definition) {
  if (definition.pooling.kind != Pooling::kByUnit) return definition.pooling.kind;
  const std::string unit = definition.unit;
  if (unit == "count") return Pooling::kCount;
  if (unit == "1/km") return Pooling::kRate;
  return unit == "%" ? Pooling::kShare : Pooling::kMean;
}

SessionWeight weightOf(Pooling kind, Subject subject) {
  switch (kind) {
    case Pooling::kCount:
    case Pooling::kRate:
      return subject == Subject::kEgo ? SessionWeight::kEgoKilometres
                                      : SessionWeight::kCbvKilometres;
    case Pooling::kShare:
      return subject == Subject::kCbvs ? SessionWeight::kCbvDecisions : SessionWeight::kSeconds;
    case Pooling::kByUnit:
    case Pooling::kMean:
    case Pooling::kStatistic:
      break;
  }
  return SessionWeight::kOne;
}

const char* weightText(SessionWeight weight) {
  switch (weight) {
    case SessionWeight::kEgoKilometres:
      return "over the km of the ego";
    case SessionWeight::kCbvKilometres:
      return "over the km of CBVs";
    case SessionWeight::kCbvDecisions:
      return "over decisions with a CBV";
    case SessionWeight::kSeconds:
      return "over simulated time";
    case SessionWeight::kByKind:
    case SessionWeight::kOne:
      break;
  }
  return "over sessions";
}

}  // namespace

PoolingRule poolingOf(const MeasureDefinition& definition) {
  PoolingRule rule = definition.pooling;
  rule.kind = kindOf(definition);
  if (rule.weight == SessionWeight::kByKind) rule.weight = weightOf(rule.kind, definition.subject);
  const bool share = rule.kind == Pooling::kShare;
  if (share || rule.kind == Pooling::kCount || rule.kind == Pooling::kRate)
    rule.least = std::max(rule.least, 0.0);
  if (share) rule.most = std::min(rule.most, 100.0);
  return rule;
}

const char* toText(Pooling kind) {
  switch (kind) {
    case Pooling::kStatistic:
      return "statistic";
    case Pooling::kCount:
      return "count";
    case Pooling::kRate:
      return "rate";
    case Pooling::kShare:
      return "share";
    case Pooling::kByUnit:
    case Pooling::kMean:
      break;
  }
  return "mean";
}

std::string poolingText(const MeasureDefinition& definition) {
  const PoolingRule rule = poolingOf(definition);
  std::string text = std::string(toText(rule.kind)) + " " + weightText(rule.weight);
  if (std::isfinite(rule.least) && std::isfinite(rule.most))
    text += ", " + core::formatNumber(rule.least) + " to " + core::formatNumber(rule.most);
  return text;
}

}  // namespace cdiff::metrics
