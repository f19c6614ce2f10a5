// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <CLI/CLI.hpp>
#include <iostream>

#include "e2e_cdiff/core/failure.h"
#include "e2e_cdiff/core/program.h"
#include "e2e_cdiff/training/trainer.h"

namespace {

enum ExitCode : int { kPassed = 0, kBadInput = 3 };

constexpr std::size_t kNameColumn = 40;  // of --help, wide enough for names and defaults

using cdiff::training::TrainingOptions;

void addRunOptions(CLI::App& program, TrainingOptions& options) {
  program.add_option("--stage", options.stage,
                     "encoder | fine_tune | denoiser | joint | export | all");
  program.add_option("--data", options.data, "Folder with *.shard")->required();
  program.add_option("--output", options.output, "Folder for checkpoints and the model")
      ->required();
  program.add_option("--init", options.init, "Model to start from where no checkpoint is");
  program.add_option("--steps", options.steps, "Steps of the stage");
  program.add_option("--batch", options.batch, "Samples a step (0: 32 on images, 128 on features)");
  program.add_option("--threads", options.threads, "Threads that compute");
  program.add_option("--seed", options.seed, "Root seed of weights, samples and noise");
  program.add_option("--time-limit", options.time_limit,
                     "Of the stage, resumptions included [s]; 0: none");
  program.add_flag("--anneal-by-time", options.anneal_by_time,
                   "The learning rate falls to 0 at the time limit");
  program.add_flag("--resume", options.resume, "Go on from the stage's checkpoint if there is one");
  program.add_option("--device", options.device, "auto | cpu | cuda");
  program.add_option("--precision", options.precision,
                     "Of the encoder in training: auto | f32 | bf16");
  program.add_option("--validation-share", options.validation_share,
                     "Share of the sessions that is held out, one at least; 0: none");
  program.add_option("--validation-samples", options.validation_samples,
                     "Held-out samples that judge, at most");
  program.add_option("--validation-every", options.validation_every,
                     "Steps between two judgements");
  program.add_option("--checkpoint-every", options.checkpoint_every, "Between two checkpoints [s]");
  program.add_option("--report-every", options.report_every, "Between two lines of progress [s]");
}

void addLearningOptions(CLI::App& program, TrainingOptions& options) {
  program.add_option("--image-scale", options.image_scale, "Of stage encoder: 1 or 0.5");
  program.add_option("--learning-rate", options.learning_rate, "After the warm-up");
  program.add_option("--weight-decay", options.weight_decay, "Of AdamW, on matrices");
  program.add_option("--warm-up", options.warm_up, "Steps over which the learning rate rises");
  program.add_option("--clip", options.clip, "Largest norm of the gradient");
  program.add_option("--route-drop", options.route_drop, "Share of samples without route");
  program.add_option("--balance", options.balance,
                     "Rare kinds of driving: 0 as collected, 1 all alike");
  program.add_option("--yielding-share", options.yielding_share,
                     "Part kept of samples that stop to give way");
  program.add_flag("!--no-mirror", options.mirror, "Do not mirror samples");
  program.add_flag("!--no-light", options.change_light, "Do not change the light of images");
}

}  // namespace

int main(int argc, char** argv) {
  cdiff::core::prepareProgram();
  CLI::App program{"cdiff_train: train the diffusion planner on collected shards"};
  TrainingOptions options;
  program.option_defaults()->always_capture_default();
  program.get_formatter()->column_width(kNameColumn);
  addRunOptions(program, options);
  addLearningOptions(program, options);
  try {
    program.parse(argc, argv);
    cdiff::training::train(options, cdiff::core::catchStopSignals(), std::cout);
  } catch (const CLI::ParseError& error) {
    return program.exit(error) == 0 ? kPassed : kBadInput;
  } catch (const std::exception& error) {
    const cdiff::core::Failure failure = cdiff::core::failureOf(error);
    std::cerr << "cdiff_train: " << failure.text << "\n";
    return failure.exit_code;
  }
  return kPassed;
}
