// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <atomic>
#include <filesystem>
#include <optional>
#include <ostream>

#include "e2e_cdiff/core/exceptions.h"
#include "learning/curve_log.h"
#include "learning/parameters.h"
#include "learning/task.h"
#include "learning/training_folder.h"
#include "learning/training_options.h"

namespace cdiff::learning {

// Runs one stage of a training from its first or a stored step to its end.

/// A loss or a weight stopped being finite. `cdiff train` exits with 2.
class DivergedError : public core::Error {
 public:
  using core::Error::Error;
};

/// What a stage came to, for the records.
struct StageResult {
  std::int64_t steps = 0;
  double seconds = 0.0;
  double loss = 0.0;  ///< running mean of the last steps
  Measures held_out;  ///< measures of the averaged weights on held-out samples
};

/// Runs a stage: steps, learning rate, log, validation, checkpoints, resumption.
class StageRunner {
 public:
  /// `facts` go into every checkpoint and must be the same in one that is resumed, as must seed and
  /// batch; a fact that the checkpoint does not know is passed over.
  StageRunner(Stage& stage, const TrainingOptions& options, const nlohmann::json& facts,
              const std::atomic<bool>& stop, std::ostream& log);

  /// Trains to the end (steps or time limit) and leaves the averaged weights in the networks.
  /// Throws DivergedError, core::Interrupted (after a checkpoint).
  StageResult run();

  /// Loads the averaged weights of a part from a checkpoint.
  static void loadAverage(const std::filesystem::path& path, const TrainedPart& part);

 private:
  void save(bool done);
  bool resume();
  void stepOrStop();
  void step();
  double clip();
  void noteNews();
  void checkFinite(double value);
  void logProgress(const Loss& loss, double norm);
  void record(const Loss& loss, double norm, double samples_per_second);
  void measureHeldOut();
  double progress() const;
  std::string progressText() const;
  double rate() const;
  double seconds() const;
  bool betweenPeriods() const { return result_.steps % rules_.period == 0; }
  bool finished() const;
  void readFacts(const nlohmann::json& facts, const std::string& source);
  template <class Visit>
  void visitTensors(Visit visit);

  Stage& stage_;
  const TrainingOptions& options_;
  StageRules rules_;
  nlohmann::json facts_;
  const std::atomic<bool>& stop_;
  std::ostream& log_;
  std::vector<TrainedPart> parts_;
  Optimizer optimizer_;
  std::optional<CurveLog> curves_;
  StageResult result_;
  Measures news_;                ///< the last of the stage
  double seconds_before_ = 0.0;  ///< of earlier runs
  double started_ = 0.0;
  double last_report_ = 0.0;
  std::int64_t last_report_step_ = 0;
  double last_checkpoint_ = 0.0;
};

}  // namespace cdiff::learning
