// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/metrics/metrics_options.h"

#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::metrics {

void MetricsOptions::describe(core::OptionsVisitor& visitor) {
  visitor.text({"speed_target", "", "What the speeds of CBVs are compared with (Wasserstein)."},
               speed_target, {"background", "normal", "file"});
  visitor.number({"speed_target_mean", "m/s", "Mean of the target normal."}, speed_target_mean, 0.0,
                 100.0);
  visitor.number({"speed_target_deviation", "m/s", "Standard deviation of the target normal."},
                 speed_target_deviation, 0.0, 100.0);
  visitor.text({"speed_target_file", "", "Speeds for the target file: one a line, or JSON."},
               speed_target_file, {});
  visitor.list({"speed_target_samples", "", "Content of that file; filled from it when empty."},
               speed_target_samples);
}

void MetricsOptions::validate() const {
  if (speed_target == "file" && speed_target_file.empty() && speed_target_samples.empty()) {
    throw core::InputError(
        "key 'metrics.speed_target' is 'file', but 'metrics.speed_target_file' is empty; expected "
        "a "
        "file of speeds [m/s], one a line, or {\"cases\": [{\"x\": [...]}]}");
  }
  if (speed_target != "file" && !speed_target_file.empty()) {
    throw core::InputError("key 'metrics.speed_target_file' is '" + speed_target_file +
                           "', but 'metrics.speed_target' is '" + speed_target +
                           "'; expected 'metrics.speed_target: file' with it");
  }
  samples();
}

std::vector<double> MetricsOptions::samples() const {
  std::vector<double> values;
  values.reserve(speed_target_samples.size());
  for (const std::string& text : speed_target_samples) {
    const auto value = core::parseNumber(text);
    if (!value || *value < 0.0) {
      throw core::InputError("key 'metrics.speed_target_samples' holds '" + text +
                             "'; expected finite speeds [m/s], none below 0");
    }
    values.push_back(*value);
  }
  return values;
}

}  // namespace cdiff::metrics
