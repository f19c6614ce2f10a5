// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <deque>
#include <string>
#include <vector>

#include "e2e_cdiff/metrics/metric.h"

namespace cdiff::metrics {

// The one table of metrics and of their measures: summary, messages, report, batch columns and
// docs/metrics.md all follow from it.

/// The shipped metrics in the order of src/metrics/CMakeLists.txt, then those that were registered.
/// References stay valid.
const std::deque<MetricDescriptor>& metricDescriptors();

/// Measures of all metrics, in the order of summary.json: by metric, but in a group of measures
/// ("/metrics/GROUP/NAME/value") by name. Every place is filled in. A registration invalidates
/// references.
const std::vector<MeasureDefinition>& measureDefinitions();
/// nullptr for an unknown name.
const MeasureDefinition* findMeasure(const std::string& name);

/// "higher is better", "lower is better" or "no direction".
const char* toText(Direction direction);
/// "of the ego", "of CBVs" or "of the ego and others".
const char* toText(Subject subject);

/// The metrics that come with the package. Their table is made from the list in
/// src/metrics/CMakeLists.txt: NAME stands for the function nameMetric().
std::vector<MetricDescriptor> shippedMetrics();

/// The rule of a measure with nothing left to its unit, subject and kind. Shares lie between 0 and
/// 100, counts and rates at 0 or above.
PoolingRule poolingOf(const MeasureDefinition& definition);

/// "mean", "statistic", "count", "rate" or "share".
const char* toText(Pooling kind);

/// For people: "share of samples, 0 to 100", "count, per km of the ego".
std::string poolingText(const MeasureDefinition& definition);

/// All measures as Markdown, for docs/metrics.md and `cdiff metric definitions`: a section for
/// each, in the order of summary.json, with name, label, unit, subject, direction, pooling, place,
/// definition and how RIFT's code differs.
std::string measureList();

}  // namespace cdiff::metrics
