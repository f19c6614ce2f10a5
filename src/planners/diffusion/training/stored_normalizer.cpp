// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/diffusion/training/stored_normalizer.h"

#include <filesystem>

#include "learning/checkpoint.h"
#include "learning/training_folder.h"
#include "planners/diffusion/training/fitted_normalizer.h"

namespace cdiff::planners {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

diffusion::Normalizer readNormalizer(const json& stored, const fs::path& path,
                                     std::int64_t horizon) {
  const std::string where = "checkpoint '" + path.string() + "': normalizer";
  if (!stored.is_string())
    throw core::InputError(where + " is no text, so an earlier version wrote it; train anew");
  const auto normalizer =
      diffusion::Normalizer::fromJson(stored.get<std::string>(), horizon, where);
  try {
    normalizer.validate(static_cast<int>(horizon));
  } catch (const core::InputError& error) {
    throw core::InputError("checkpoint '" + path.string() + "': " + error.what());
  }
  return normalizer;
}

/// Stages whose checkpoints the run takes weights from; those it goes on with are the first.
std::vector<std::string> sourcesOf(const learning::TrainingOptions& options) {
  if (options.stage == "export") return {"joint", "denoiser"};
  std::vector<std::string> stages;
  if (options.resume && options.stage == "all") stages = {"encoder", "fine_tune", "denoiser"};
  if (options.resume && options.stage != "all") stages = {options.stage};
  if (options.stage == "fine_tune") stages.emplace_back("encoder");
  if (options.stage == "joint") stages.emplace_back("denoiser");
  return stages;
}

}  // namespace

diffusion::Normalizer chooseNormalizer(const learning::TrainingOptions& options, bool mirror,
                                       const learning::DrivingDataset& dataset,
                                       const diffusion::Model* init) {
  for (const std::string& stage : sourcesOf(options)) {
    const fs::path path = learning::checkpointPath(options.output, stage);
    if (!fs::exists(path)) continue;
    const json facts = learning::readCheckpoint(path).facts;
    // One without is of a time when each run fitted its own.
    if (!facts.contains("normalizer")) return fitNormalizer(dataset, mirror);
    return readNormalizer(facts.at("normalizer"), path, dataset.schema().horizon);
  }
  return init != nullptr ? init->normalizer : fitNormalizer(dataset, mirror);
}

}  // namespace cdiff::planners
