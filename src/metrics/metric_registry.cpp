// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "metrics/metric_registry.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/registry.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::metrics {

namespace {

class Registry {
 public:
  Registry() {
    for (MetricDescriptor& descriptor : shippedMetrics()) add(std::move(descriptor));
  }

  void add(MetricDescriptor descriptor) {
    check(descriptor);
    for (MeasureDefinition& definition : descriptor.measures) {
      if (*definition.place == '\0') definition.place = defaultPlace(definition);
    }
    requireNew(descriptor);
    const std::string source = descriptor.source;
    const std::vector<MeasureDefinition> measures = descriptor.measures;
    metrics_.add(std::move(descriptor), source);
    for (const MeasureDefinition& definition : measures) insert(definition);
  }

  const std::deque<MetricDescriptor>& metrics() const { return metrics_.entries(); }
  const std::vector<MeasureDefinition>& measures() const { return measures_; }

 private:
  /// At the end; in a group of measures, by name.
  void insert(const MeasureDefinition& definition) {
    const std::string group = groupOf(definition);
    auto place = measures_.end();
    if (!group.empty()) {
      const auto after = [&](const MeasureDefinition& other) {
        return groupOf(other) == group && std::string(other.name) > definition.name;
      };
      place = std::find_if(measures_.begin(), measures_.end(), after);
    }
    measures_.insert(place, definition);
  }

  /// The group that "/metrics/GROUP/NAME/value" says; empty for any other place.
  static std::string groupOf(const MeasureDefinition& definition) {
    const std::vector<std::string> keys = core::splitText(definition.place, '/');
    return keys.size() == 4 ? keys[1] : std::string();
  }

  const char* defaultPlace(const MeasureDefinition& definition) {
    places_.push_back("/metrics/" + std::string(definition.name) + "/value");
    return places_.back().c_str();
  }

  /// Names are columns and topics; places are looked for below /ego, /cbv and /metrics alone.
  static void checkMeasure(const MeasureDefinition& definition,
                           const MetricDescriptor& descriptor) {
    const std::string what = "measure '" + std::string(definition.name) + "' of metric '" +
                             descriptor.name + "' of " + descriptor.source;
    if (!core::isSnakeCase(definition.name))
      throw core::InputError(what + ": its name must be snake_case");
    const std::string place = definition.place;
    const std::vector<std::string> keys = core::splitText(place, '/');
    const bool known = !keys.empty() && place.front() == '/' && place.back() != '/' &&
                       (keys[0] == "ego" || keys[0] == "cbv" || keys[0] == "metrics");
    if (!place.empty() && (!known || keys.size() < 2))
      throw core::InputError(what + ": its place '" + place +
                             "' must lie below /ego, /cbv or /metrics");
  }

  void check(const MetricDescriptor& descriptor) const {
    if (descriptor.measures.empty() || !descriptor.make) {
      throw core::InputError("metric '" + descriptor.name + "' of " + descriptor.source +
                             " lacks measures or 'make'");
    }
    for (const MeasureDefinition& definition : descriptor.measures)
      checkMeasure(definition, descriptor);
  }

  static bool sameNameOrPlace(const MeasureDefinition& one, const MeasureDefinition& other) {
    return std::string(one.name) == other.name || std::string(one.place) == other.place;
  }

  /// Its places are filled in.
  void requireNew(const MetricDescriptor& descriptor) const {
    const std::vector<MeasureDefinition>& own = descriptor.measures;
    for (std::size_t i = 0; i < own.size(); ++i) {
      const auto same = [&](const MeasureDefinition& one) { return sameNameOrPlace(one, own[i]); };
      const std::string what = "measure '" + std::string(own[i].name) + "'";
      if (std::any_of(own.begin(), own.begin() + static_cast<std::ptrdiff_t>(i), same))
        refuse(what, descriptor, descriptor);
      for (const MetricDescriptor& other : metrics()) {
        if (other.name == descriptor.name) continue;  // metrics_ refuses it
        if (std::any_of(other.measures.begin(), other.measures.end(), same))
          refuse(what, other, descriptor);
      }
    }
  }

  [[noreturn]] static void refuse(const std::string& what, const MetricDescriptor& first,
                                  const MetricDescriptor& second) {
    throw core::InputError(what + " is registered twice, by " + first.source + " (metric '" +
                           first.name + "') and by " + second.source + " (metric '" + second.name +
                           "')");
  }

  core::Registry<MetricDescriptor> metrics_{"metric", {}};
  std::vector<MeasureDefinition> measures_;
  std::deque<std::string> places_;  ///< texts of places that were filled in
};

/// Never destroyed: it holds functions of plug-ins, whose libraries may be unloaded before.
Registry& registry() {
  static Registry& instance = *new Registry;
  return instance;
}

}  // namespace

void registerMetric(MetricDescriptor descriptor) { registry().add(std::move(descriptor)); }

const std::deque<MetricDescriptor>& metricDescriptors() { return registry().metrics(); }

const std::vector<MeasureDefinition>& measureDefinitions() { return registry().measures(); }

const MeasureDefinition* findMeasure(const std::string& name) {
  const auto& all = measureDefinitions();
  const auto found = std::find_if(all.begin(), all.end(),
                                  [&](const MeasureDefinition& row) { return name == row.name; });
  return found == all.end() ? nullptr : &*found;
}

const char* toText(Direction direction) {
  switch (direction) {
    case Direction::kHigherIsBetter:
      return "higher is better";
    case Direction::kLowerIsBetter:
      return "lower is better";
    case Direction::kNeither:
      break;
  }
  return "no direction";
}

const char* toText(Subject subject) {
  switch (subject) {
    case Subject::kEgo:
      return "of the ego";
    case Subject::kCbvs:
      return "of CBVs";
    case Subject::kEgoAndOthers:
      break;
  }
  return "of the ego and others";
}

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
    case SessionWeight::kCbvSelections:
      return "over selected CBVs";
    case SessionWeight::kSeconds:
      return "over simulated time";
    case SessionWeight::kTtcSeconds:
      return "over the time with a 2D-TTC";
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

std::string measureList() {
  std::string list;
  for (const MeasureDefinition& definition : measureDefinitions()) {
    const std::string unit = *definition.unit ? definition.unit : "without unit";
    list += "### `" + std::string(definition.name) + "`\n\n" + definition.label + "; " + unit +
            "; " + toText(definition.subject) + "; " + toText(definition.direction) + "; " +
            poolingText(definition) + "; `" + definition.place + "`\n\n" + definition.definition +
            "\n\n";
    if (*definition.rift_compat)
      list += "rift_compat: " + std::string(definition.rift_compat) + "\n\n";
  }
  return list;
}

}  // namespace cdiff::metrics
