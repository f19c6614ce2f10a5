// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/diffusion/training/training_settings.h"

#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::planners {

void DiffusionTrainingSettings::describe(core::OptionsVisitor& visitor) {
  visitor.text({"precision", "", "Of the encoder in training."}, precision,
               {"auto", "f32", "bf16"});
  visitor.text({"loss", "", "Of diffusion stages: first actions weighted, or the paper's."}, loss,
               {"weighted", "plain"});
  visitor.number({"image_scale", "", "Size of images in stage encoder: 1 or 0.5."}, image_scale,
                 0.5, 1.0);
  visitor.number({"route_drop", "", "Share of samples without route."}, route_drop, 0.0, 1.0);
  visitor.number({"balance", "", "Rare kinds of driving: 0 as collected, 1 all equally often."},
                 balance, 0.0, 1.0);
  visitor.number({"yielding_share", "", "Part kept of samples that stop to give way."},
                 yielding_share, 0.0, 1.0);
  visitor.flag({"mirror", "", "Mirror every second sample."}, mirror);
  visitor.flag({"light", "", "Change the light of images."}, change_light);
}

void DiffusionTrainingSettings::validate() const {
  if (image_scale == 1.0 || image_scale == 0.5) return;
  throw core::InputError("training: image_scale is " + core::formatNumber(image_scale) +
                         "; expected 1 or 0.5");
}

}  // namespace cdiff::planners
