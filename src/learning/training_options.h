// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "e2e_cdiff/core/options.h"

namespace CLI {
class App;
}

namespace cdiff::learning {

class Task;

/// Options of every training, whatever is learned.
struct TrainingOptions {
  std::string task;            ///< name in the table of tasks
  std::string stage = "all";   ///< one of the task's | export | all
  std::string data;            ///< folder with *.shard, or *.scene for tasks that learn from scenes
  std::string output;          ///< folder for checkpoints and the model
  std::string init;            ///< model to start from where no checkpoint is; empty: none
  std::int64_t steps = 20000;  ///< steps of the stage
  std::int64_t batch = 0;      ///< samples per step; 0: what the stage takes by itself
  std::int64_t threads = 1;
  std::int64_t seed = 1;
  double time_limit = 0.0;  ///< time limit of the stage's steps, over all resumptions [s]; 0: none
  bool anneal_by_time = false;  ///< learning rate falls with time instead of steps
  bool resume = false;          ///< the stage goes on from its checkpoint if there is one
  bool overwrite = false;       ///< the stage replaces an earlier training
  std::string device = "auto";  ///< auto | cpu | cuda
  double learning_rate = 2e-4;
  double weight_decay = 1e-4;
  double second_decay = 0.999;    ///< b2 of AdamW, decay of the mean of squared gradients
  std::int64_t warm_up = 500;     ///< steps
  double clip = 1.0;              ///< norm of the gradient
  double average_decay = 0.999;   ///< decay of the moving average of the weights, at most
  double validation_share = 0.1;  ///< share of the sessions that is held out
  std::int64_t validation_samples = 256;
  std::int64_t validation_every = 1000;  ///< steps
  double checkpoint_every = 300.0;       ///< [s]
  double report_every = 10.0;            ///< [s]
};

/// A task with all options of its training; a copy shares the task.
struct Training {
  TrainingOptions options;
  std::shared_ptr<Task> task;
  std::vector<std::string> tasks;  ///< names that `options.task` may have

  void describe(core::OptionsVisitor& visitor);
  /// Throws InputError naming the key.
  void validate() const;
  /// Whether a data folder must be given.
  bool needsSamples() const;
};

// The options of an options struct on the command line: `--steps 10` for the key `steps`, a flag
// for each key that is true or false, `--no-KEY` where it is true unless given.

/// Adds an option for each field, with its meaning, unit, choices and default. What is given goes
/// into `training`, which must outlive `program`; a value that is refused throws InputError naming
/// option and range when the program parses.
void addOptions(CLI::App& program, Training& training);

}  // namespace cdiff::learning
