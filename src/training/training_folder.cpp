// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "training/training_folder.h"

#include <algorithm>
#include <filesystem>

#include "training/stage_runner.h"

namespace cdiff::training {
namespace {

namespace fs = std::filesystem;
using core::InputError;
using Names = std::vector<std::string>;

const Names kStages = {"encoder", "fine_tune", "denoiser", "joint"};
const Names kModelFiles = {"encoder.safetensors", "denoiser.safetensors"};
const Names kOtherFiles = {"training.json", "model_card.md", "curves.csv", "training.html",
                           "features.cache"};

bool hasCheckpoint(const TrainingOptions& options, const std::string& stage) {
  return fs::exists(StageRunner::pathOf(options.output, stage));
}

bool hasAny(const TrainingOptions& options, const Names& stages) {
  return std::any_of(stages.begin(), stages.end(),
                     [&](const std::string& stage) { return hasCheckpoint(options, stage); });
}

/// Stages that the run trains anew. Those of an earlier training that `all` leaves out count, too:
/// its later stages would start from them.
Names trainedStages(const TrainingOptions& options) {
  if (options.stage == "all") return kStages;
  return options.stage == "export" ? Names{} : Names{options.stage};
}

void requireSource(const TrainingOptions& options, const Names& sources, const std::string& part,
                   const std::string& first) {
  if (sources.empty() || !options.init.empty() || hasAny(options, sources)) return;
  throw InputError("training: '" + options.output + "' holds no checkpoint of " + part +
                   "; train stage '" + first + "' first, or give a model with init");
}

void removeFile(const fs::path& file) {
  std::error_code error;
  fs::remove(file, error);
  if (error) throw InputError("cannot replace '" + file.string() + "': " + error.message());
}

}  // namespace

Names encoderSources(const std::string& stage) {
  if (stage == "fine_tune") return {"encoder"};
  if (stage == "denoiser" || stage == "joint") return {"fine_tune", "encoder"};
  return stage == "export" ? Names{"joint", "fine_tune", "encoder"} : Names{};
}

Names denoiserSources(const std::string& stage) {
  return stage == "export" ? Names{"joint", "denoiser"} : Names{};
}

void requireSources(const TrainingOptions& options) {
  requireSource(options, encoderSources(options.stage), "an encoder", "encoder");
  requireSource(options, denoiserSources(options.stage), "a denoiser", "denoiser");
}

void requireFreeOutput(const TrainingOptions& options) {
  if (options.overwrite) return;
  const std::string folder = "'" + options.output + "'";
  for (const std::string& stage : trainedStages(options)) {
    if (options.resume || !hasCheckpoint(options, stage)) continue;
    throw InputError(folder + " holds a training of stage '" + stage + "' (" + stage +
                     ".checkpoint); go on with it (--resume), replace it (--overwrite), or give "
                     "another --output");
  }
  if (hasAny(options, kStages)) return;
  for (const std::string& file : kModelFiles) {
    if (!fs::exists(fs::path(options.output) / file)) continue;
    throw InputError(folder + " holds a model (" + file +
                     ") without the checkpoints of its training; replace it (--overwrite), or "
                     "give another --output");
  }
}

void removeEarlier(const TrainingOptions& options) {
  if (!options.overwrite) return;
  for (const std::string& stage : trainedStages(options))
    removeFile(StageRunner::pathOf(options.output, stage));
  if (options.stage != "all") return;
  for (const Names* files : {&kModelFiles, &kOtherFiles}) {
    for (const std::string& file : *files) removeFile(fs::path(options.output) / file);
  }
}

}  // namespace cdiff::training
