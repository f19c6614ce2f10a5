// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "stored_normalizer.h"

#include <filesystem>
#include <optional>

#include "checkpoint.h"
#include "e2e_cdiff/diffusion/model.h"
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

/// Checkpoints without a normalizer are of a time when each run fitted its own.
std::optional<diffusion::Normalizer> normalizerIn(const fs::path& path, std::int64_t horizon) {
  if (!fs::exists(path)) return std::nullopt;
  const json facts = readCheckpoint(path).facts;
  if (!facts.contains("normalizer")) return std::nullopt;
  try {
    const json& stored = facts.at("normalizer");
    const diffusion::Normalizer normalizer{matrixOf(stored.at("mean")),
                                           matrixOf(stored.at("scale"))};
    normalizer.validate(static_cast<int>(horizon));
    return normalizer;
  } catch (const std::exception& error) {
    throw core::InputError("checkpoint '" + path.string() + "': " + error.what());
  }
}

/// Stages whose checkpoints the run takes weights from, first those it goes on with.
std::vector<std::string> sourcesOf(const TrainingOptions& options) {
  std::vector<std::string> stages;
  if (options.resume) {
    if (options.stage == "all") return {"denoiser", "fine_tune", "encoder"};
    stages.push_back(options.stage);
  }
  if (options.stage == "joint") stages.emplace_back("denoiser");
  if (options.stage == "export") stages = {"joint", "denoiser"};
  return stages;
}

}  // namespace

json normalizerFacts(const diffusion::Normalizer& normalizer) {
  return {{"mean", rowsOf(normalizer.mean)}, {"scale", rowsOf(normalizer.scale)}};
}

diffusion::Normalizer chooseNormalizer(const TrainingOptions& options, const Dataset& dataset) {
  for (const std::string& stage : sourcesOf(options)) {
    const auto stored =
        normalizerIn(StageRunner::pathOf(options.output, stage), dataset.schema().horizon);
    if (stored) return *stored;
  }
  if (!options.init.empty()) return diffusion::loadModel(options.init).normalizer;
  return fitNormalizer(dataset, options.mirror);
}

}  // namespace cdiff::training
