// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <vector>

#include "e2e_cdiff/guidance/objective.h"
#include "e2e_cdiff/metrics/metric.h"
#include "e2e_cdiff/planning/planner_descriptor.h"

namespace cdiff::plugins {

/// Rises when a header of include/e2e_cdiff changes so that a compiled plug-in no longer fits.
inline constexpr int kApiVersion = 5;

/// What a package of the user's own adds: planners, guidance objectives, metrics.
///
/// A library exports one class or more:
///
///     class MyPlugin : public cdiff::plugins::Plugin { ... };
///     CLASS_LOADER_REGISTER_CLASS(MyPlugin, cdiff::plugins::Plugin)
///
/// and its package names the library in package.xml:
///
///     <export><e2e_cdiff plugin="libmy_plugins.so"/></export>
///
/// `examples/my_plugins` is a whole package.
class Plugin {
 public:
  virtual ~Plugin() = default;
  /// Compiled into the plug-in, and the first function of the class in every version. Hidden, so
  /// that no library's answer is taken for another's.
  [[gnu::visibility("hidden")]] virtual int apiVersion() const { return kApiVersion; }
  /// Planners that scenarios may then name.
  virtual std::vector<planning::PlannerDescriptor> planners() const { return {}; }
  /// Objectives that guidance profiles may then name.
  virtual std::vector<guidance::ObjectiveDescriptor> objectives() const { return {}; }
  /// Metrics that every session then has.
  virtual std::vector<metrics::MetricDescriptor> metrics() const { return {}; }
};

}  // namespace cdiff::plugins
