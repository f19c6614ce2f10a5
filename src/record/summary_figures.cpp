// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "record/summary_figures.h"

#include "core/text.h"
#include "metrics/metric_registry.h"

namespace cdiff::record {
namespace {

/// {value, n, unit} and, where there is one, the reason (why absent, or how thinned out) and the
/// target that it is compared with.
Json measureObject(const metrics::Measure& measure) {
  Json object = {{"value", number(measure.value)}, {"n", measure.n}, {"unit", measure.unit}};
  if (!measure.reason.empty()) object["reason"] = measure.reason;
  if (!measure.target.empty()) object["target"] = measure.target;
  return object;
}

/// Adds `leaf` to a distribution's object: its values, then n and, where there is one, the reason.
void addToDistribution(Json& object, const std::string& leaf, const metrics::Measure& measure) {
  if (object.is_null()) object = Json::object();
  const std::string reason = object.value("reason", measure.reason);
  object.erase("n");
  object.erase("reason");
  object[leaf] = number(measure.value);
  object["n"] = measure.n;
  if (!reason.empty()) object["reason"] = reason;
}

Json entryList(const std::vector<metrics::MetricEntry>& entries) {
  Json list = Json::array();
  for (const metrics::MetricEntry& entry : entries) {
    list.push_back(Json::object());
    for (const auto& [key, value] : entry)
      std::visit([&, &name = key](const auto& content) { list.back()[name] = content; }, value);
  }
  return list;
}

}  // namespace

Json number(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

void addMeasure(Json& object, const std::string& key, const metrics::Measure& measure) {
  object[key] = number(measure.value);
  if (!measure.reason.empty()) object[key + "_reason"] = measure.reason;
}

void addPlainFigure(Json& object, const std::string& key, const metrics::Measure& measure) {
  addMeasure(object, key, measure);
  if (measure.unit == "count" && measure.value)
    object[key] = static_cast<std::uint64_t>(*measure.value);
}

void addFigures(Json& object, const std::string& section,
                const metrics::SessionMeasures& measures) {
  for (const metrics::FigureDefinition& figure : metrics::figureDefinitions()) {
    const std::vector<std::string> keys = core::splitText(figure.place, '/');
    if (keys.front() != section) continue;
    const metrics::Measure measure = measures.at(figure);
    if (keys.size() == 2) {
      addPlainFigure(object, keys[1], measure);
      continue;
    }
    Json* parent = &object;
    for (std::size_t i = 1; i + 1 < keys.size(); ++i) parent = &(*parent)[keys[i]];
    if (keys.back() == "value") {
      *parent = measureObject(measure);
    } else {
      addToDistribution(*parent, keys.back(), measure);
    }
  }
  for (const auto& [place, entries] : measures.lists) {
    const std::vector<std::string> keys = core::splitText(place, '/');
    if (keys.front() == section) object[keys.back()] = entryList(entries);
  }
}

}  // namespace cdiff::record
