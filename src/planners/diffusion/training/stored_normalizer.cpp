// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/diffusion/training/stored_normalizer.h"

#include <array>
#include <cmath>
#include <filesystem>

#include "learning/samples/driving_sample.h"
#include "learning/training_folder.h"

namespace cdiff::planners {
namespace {

using traffic::Rollout;

/// Least standard deviation of a state cell: x, y [m], heading [rad], speed [m/s].
constexpr std::array<double, traffic::kStateColumns> kLeastDeviation = {0.05, 0.05, 0.01, 0.1};
constexpr double kLeastSteerScale = 0.05;

}  // namespace

diffusion::Normalizer fitNormalizer(const learning::DrivingDataset& dataset, bool mirrored) {
  const Eigen::Index horizon = dataset.schema().horizon;
  Rollout sum = Rollout::Zero(horizon, traffic::kRolloutColumns);
  Rollout squares = sum;
  double count = 0.0;
  for (const std::size_t index : dataset.training()) {
    Rollout rollout = dataset.withoutImage(index).rollout;
    for (int pass = 0; pass < (mirrored ? 2 : 1); ++pass) {
      if (pass == 1) learning::mirrorRollout(rollout);
      sum += rollout;
      squares += rollout.cwiseProduct(rollout);
      count += 1.0;
    }
  }
  diffusion::Normalizer normalizer{sum / count, squares / count};
  normalizer.scale =
      (normalizer.scale - normalizer.mean.cwiseProduct(normalizer.mean)).cwiseMax(0.0).cwiseSqrt();
  for (int column = 0; column < traffic::kStateColumns; ++column) {
    const double least = kLeastDeviation[static_cast<std::size_t>(column)];
    normalizer.scale.col(column) = normalizer.scale.col(column).cwiseMax(least);
  }
  for (const int column : {traffic::kRolloutThrottle, traffic::kRolloutBrake}) {
    normalizer.mean.col(column).setConstant(0.5);
    normalizer.scale.col(column).setConstant(0.5);
  }
  const double steer = std::sqrt(squares.col(traffic::kRolloutSteer).mean() / count);
  normalizer.mean.col(traffic::kRolloutSteer).setZero();
  normalizer.scale.col(traffic::kRolloutSteer).setConstant(std::max(2.0 * steer, kLeastSteerScale));
  return normalizer;
}

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
