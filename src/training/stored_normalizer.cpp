// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "stored_normalizer.h"

#include <filesystem>

#include "checkpoint.h"
#include "stage_runner.h"

namespace cdiff::training {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using traffic::Rollout;

json rowsOf(const Rollout& matrix) {
  json rows = json::array();
  for (Eigen::Index t = 0; t < matrix.rows(); ++t) {
    json row = json::array();
    for (Eigen::Index column = 0; column < matrix.cols(); ++column)
      row.push_back(matrix(t, column));
    rows.push_back(row);
  }
  return rows;
}

Rollout matrixOf(const json& rows) {
  Rollout matrix(static_cast<Eigen::Index>(rows.size()), traffic::kRolloutColumns);
  for (std::size_t t = 0; t < rows.size(); ++t) {
    for (std::size_t column = 0; column < traffic::kRolloutColumns; ++column)
      matrix(static_cast<Eigen::Index>(t), static_cast<Eigen::Index>(column)) =
          rows.at(t).at(column).get<double>();
  }
  return matrix;
}

diffusion::Normalizer readNormalizer(const json& stored, const fs::path& path, int horizon) {
  try {
    const diffusion::Normalizer normalizer{matrixOf(stored.at("mean")),
                                           matrixOf(stored.at("scale"))};
    normalizer.validate(horizon);
    return normalizer;
  } catch (const std::exception& error) {
    throw core::InputError("checkpoint '" + path.string() + "': normalizer: " + error.what());
  }
}

/// Stages whose checkpoints the run takes weights from; those it goes on with are the first.
std::vector<std::string> sourcesOf(const TrainingOptions& options) {
  if (options.stage == "export") return {"joint", "denoiser"};
  std::vector<std::string> stages;
  if (options.resume && options.stage == "all") stages = {"encoder", "fine_tune", "denoiser"};
  if (options.resume && options.stage != "all") stages = {options.stage};
  if (options.stage == "fine_tune") stages.emplace_back("encoder");
  if (options.stage == "joint") stages.emplace_back("denoiser");
  return stages;
}

}  // namespace

json normalizerFacts(const diffusion::Normalizer& normalizer) {
  return {{"mean", rowsOf(normalizer.mean)}, {"scale", rowsOf(normalizer.scale)}};
}

diffusion::Normalizer chooseNormalizer(const TrainingOptions& options, const Dataset& dataset,
                                       const diffusion::Model* init) {
  for (const std::string& stage : sourcesOf(options)) {
    const fs::path path = StageRunner::pathOf(options.output, stage);
    if (!fs::exists(path)) continue;
    const json facts = readCheckpoint(path).facts;
    // One without is of a time when each run fitted its own.
    if (!facts.contains("normalizer")) return fitNormalizer(dataset, options.mirror);
    return readNormalizer(facts.at("normalizer"), path, static_cast<int>(dataset.schema().horizon));
  }
  return init != nullptr ? init->normalizer : fitNormalizer(dataset, options.mirror);
}

}  // namespace cdiff::training
