// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "core/text.h"
#include "training/trainer.h"

namespace cdiff::training {
namespace {

using core::InputError;
using core::OptionsVisitor;

constexpr std::int64_t kMost = 1000000000;  // steps or samples
constexpr double kLongest = 1e7;            // [s]

void describeRun(TrainingOptions& options, OptionsVisitor& visitor) {
  visitor.text({"stage", "", "Stage to train; all: encoder, fine_tune where needed, denoiser."},
               options.stage, {"encoder", "fine_tune", "denoiser", "joint", "export", "all"});
  visitor.text({"data", "", "Folder with *.shard."}, options.data, {});
  visitor.text({"output", "", "Folder for checkpoints and the model."}, options.output, {});
  visitor.text({"init", "", "Model to start from where no checkpoint is."}, options.init, {});
  visitor.integer({"steps", "", "Steps of the stage."}, options.steps, 1, kMost);
  visitor.integer({"batch", "", "Samples a step; 0: 32 on images, 128 on features."}, options.batch,
                  0, kMost);
  visitor.integer({"threads", "", "Threads that compute."}, options.threads, 1, 256);
  visitor.integer({"seed", "", "Root seed of weights, samples and noise."}, options.seed, 0,
                  2147483647);
  visitor.flag({"resume", "", "Go on from the stage's checkpoint if there is one."},
               options.resume);
  visitor.flag({"overwrite", "", "Replace an earlier training of the stage in the folder."},
               options.overwrite);
  visitor.text({"device", "", "Where to compute."}, options.device, {"auto", "cpu", "cuda"});
  visitor.text({"precision", "", "Of the encoder in training."}, options.precision,
               {"auto", "f32", "bf16"});
}

void describeTimes(TrainingOptions& options, OptionsVisitor& visitor) {
  visitor.number(
      {"time_limit", "s",
       "Time for the steps of the stage, resumptions included; computing features and the "
       "last judgement come on top; 0: none."},
      options.time_limit, 0.0, kLongest);
  visitor.flag({"anneal_by_time", "", "The learning rate falls to 0 at the time limit."},
               options.anneal_by_time);
  visitor.number({"checkpoint_every", "s", "Between two checkpoints."}, options.checkpoint_every,
                 0.0, kLongest);
  visitor.number({"report_every", "s", "Between two lines of progress."}, options.report_every, 0.0,
                 kLongest);
}

void describeValidation(TrainingOptions& options, OptionsVisitor& visitor) {
  visitor.number({"validation_share", "",
                  "Share of the sessions that is held out, one at least; 0: none, and the training "
                  "samples judge."},
                 options.validation_share, 0.0, 0.9);
  visitor.integer({"validation_samples", "", "Held-out samples that judge, at most."},
                  options.validation_samples, 1, kMost);
  visitor.integer({"validation_every", "", "Steps between two judgements."},
                  options.validation_every, 1, kMost);
}

void describeOptimizer(TrainingOptions& options, OptionsVisitor& visitor) {
  visitor.number({"learning_rate", "", "Learning rate after the warm-up."}, options.learning_rate,
                 1e-9, 1.0);
  visitor.number({"weight_decay", "", "Weight decay of AdamW, on matrices."}, options.weight_decay,
                 0.0, 1.0);
  visitor.integer({"warm_up", "", "Steps over which the learning rate rises."}, options.warm_up, 0,
                  kMost);
  visitor.number({"clip", "", "Largest norm of the gradient."}, options.clip, 1e-6, 1e6);
  visitor.number({"average_decay", "", "Decay of the moving average of the weights, at most."},
                 options.average_decay, 0.0, 1.0);
}

void describeSamples(TrainingOptions& options, OptionsVisitor& visitor) {
  visitor.number({"image_scale", "", "Size of images in stage encoder: 1 or 0.5."},
                 options.image_scale, 0.5, 1.0);
  visitor.number({"route_drop", "", "Share of samples without route."}, options.route_drop, 0.0,
                 1.0);
  visitor.number({"balance", "", "Rare kinds of driving: 0 as collected, 1 all alike."},
                 options.balance, 0.0, 1.0);
  visitor.number({"yielding_share", "", "Part kept of samples that stop to give way."},
                 options.yielding_share, 0.0, 1.0);
  visitor.flag({"mirror", "", "Mirror every second sample."}, options.mirror);
  visitor.flag({"light", "", "Change the light of images."}, options.change_light);
}

}  // namespace

void TrainingOptions::describe(OptionsVisitor& visitor) {
  describeRun(*this, visitor);
  describeTimes(*this, visitor);
  describeValidation(*this, visitor);
  describeOptimizer(*this, visitor);
  describeSamples(*this, visitor);
}

void TrainingOptions::validate() const {
  TrainingOptions checked;
  core::loadOptions({"training options", core::dumpOptions(*this)}, checked);
  if (data.empty()) throw InputError("training: data, the folder of the shards, is not given");
  if (output.empty()) throw InputError("training: output, the folder to write to, is not given");
  if (resume && overwrite) {
    throw InputError(
        "training: resume and overwrite are both set; expected one of them: go on with the "
        "training in the folder, or replace it");
  }
  if (anneal_by_time && time_limit <= 0.0)
    throw InputError("training: anneal_by_time needs a time_limit");
  if (image_scale != 1.0 && image_scale != 0.5) {
    throw InputError("training: image_scale is " + core::formatNumber(image_scale) +
                     "; expected 1 or 0.5");
  }
}

}  // namespace cdiff::training
