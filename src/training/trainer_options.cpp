// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <algorithm>
#include <vector>

#include "e2e_cdiff/core/text.h"
#include "e2e_cdiff/training/trainer.h"

namespace cdiff::training {
namespace {

using core::InputError;

void requireOneOf(const char* option, const std::string& value,
                  const std::vector<std::string>& choices) {
  if (std::find(choices.begin(), choices.end(), value) != choices.end()) return;
  throw InputError(std::string("training: ") + option + " is '" + value + "', must be one of " +
                   core::joinText(choices, ", "));
}

void requireRange(const char* option, double value, double minimum, double maximum) {
  if (value >= minimum && value <= maximum) return;
  throw InputError(std::string("training: ") + option + " is " + core::formatNumber(value) +
                   ", must lie in [" + core::formatNumber(minimum) + ", " +
                   core::formatNumber(maximum) + "]");
}

void requireCount(const char* option, std::int64_t value, std::int64_t minimum) {
  requireRange(option, static_cast<double>(value), static_cast<double>(minimum), 1e9);
}

}  // namespace

void TrainingOptions::validate() const {
  requireOneOf("stage", stage, {"encoder", "fine_tune", "denoiser", "joint", "export", "all"});
  requireOneOf("device", device, {"auto", "cpu", "cuda"});
  requireOneOf("precision", precision, {"auto", "f32", "bf16"});
  if (data.empty()) throw InputError("training: data, the folder of the shards, is not given");
  if (output.empty()) throw InputError("training: output, the folder to write to, is not given");
  requireCount("steps", steps, 1);
  requireCount("batch", batch, 0);
  requireRange("threads", static_cast<double>(threads), 1, 256);
  requireCount("warm_up", warm_up, 0);
  requireCount("validation_samples", validation_samples, 1);
  requireCount("validation_every", validation_every, 1);
  requireRange("time_limit", time_limit, 0.0, 1e7);
  if (anneal_by_time && time_limit <= 0.0)
    throw InputError("training: anneal_by_time needs a time_limit");
  if (image_scale != 1.0 && image_scale != 0.5)
    requireRange("image_scale (1 or 0.5)", image_scale, 1.0, 1.0);
  requireRange("learning_rate", learning_rate, 1e-9, 1.0);
  requireRange("weight_decay", weight_decay, 0.0, 1.0);
  requireRange("clip", clip, 1e-6, 1e6);
  requireRange("average_decay", average_decay, 0.0, 1.0);
  requireRange("route_drop", route_drop, 0.0, 1.0);
  requireRange("balance", balance, 0.0, 1.0);
  requireRange("yielding_share", yielding_share, 0.0, 1.0);
  requireRange("validation_share", validation_share, 0.0, 0.9);
  requireRange("checkpoint_every", checkpoint_every, 0.0, 1e7);
  requireRange("report_every", report_every, 0.0, 1e7);
}

}  // namespace cdiff::training
