// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/diffusion/training/prepared_data.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <ostream>
#include <thread>

#include "core/file.h"
#include "diffusion/network/image_encoder.h"
#include "inference/precision.h"
#include "learning/batches.h"
#include "learning/samples/driving_sample.h"
#include "learning/training_folder.h"

namespace cdiff::planners {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::size_t kChunk = 32;

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::string hashOf(const learning::ParameterSet& parameters) {
  core::Sha256 digest;
  for (const at::Tensor& tensor : parameters.tensors()) {
    const at::Tensor plain = tensor.detach().to(at::kCPU).contiguous();
    digest.update({static_cast<const char*>(plain.data_ptr()),
                   static_cast<std::size_t>(plain.numel()) * sizeof(float)});
  }
  return digest.finish();
}

std::vector<learning::DrivingSample> samplesOf(const TrainingState& state, std::size_t begin,
                                               std::size_t end) {
  std::vector<learning::DrivingSample> samples;
  for (std::size_t i = begin; i < end; ++i) {
    samples.push_back(state.dataset.sample(i));
    if (state.settings.mirror && mirroredInCache(i))
      learning::mirrorSample(state.dataset.schema(), samples.back());
  }
  return samples;
}

using Images = std::vector<const traffic::CameraImage*>;

/// That of `diffusion.precision: auto`, so that the denoiser learns on the features it will be
/// given, or float32 where the training names a precision.
inference::Precision featurePrecision(const DiffusionTrainingSettings& settings) {
  return inference::precisionNamed(settings.precision == "auto" ? "auto" : "fp32", "auto",
                                   "precision");
}

/// Encodes images: on a CPU by the encoder that drives, one thread per encoder, which is faster
/// than the one that learns; else by the latter.
class Encoders {
 public:
  explicit Encoders(const TrainingState& state) : state_(state) {
    if (!state.run.device.is_cpu()) return;
    diffusion::Model model;
    model.architecture = state.architecture;
    model.encoder = state.encoder.parameters().values();
    const auto threads =
        static_cast<std::size_t>(std::max<std::int64_t>(1, state.run.options.threads));
    for (std::size_t i = 0; i < threads; ++i)
      encoders_.emplace_back(model, featurePrecision(state.settings));
  }

  at::Tensor encode(const Images& images) {
    if (encoders_.empty()) {
      return state_.encoder.forward(learning::imageTensor(images, 1.0, state_.run.device))
          .to(at::kCPU);
    }
    const auto width = static_cast<std::size_t>(state_.architecture.image_features);
    std::vector<float> features(images.size() * width);
    std::vector<std::thread> threads;
    for (std::size_t first = 0; first < encoders_.size(); ++first) {
      threads.emplace_back([&, first] {
        for (std::size_t i = first; i < images.size(); i += encoders_.size()) {
          const std::vector<float> one = encoders_[first].encode(*images[i]);
          std::copy(one.begin(), one.end(), features.begin() + static_cast<long>(i * width));
        }
      });
    }
    for (std::thread& thread : threads) thread.join();
    return learning::toTensor(
        features, {static_cast<std::int64_t>(images.size()), static_cast<std::int64_t>(width)},
        at::kCPU);
  }

 private:
  const TrainingState& state_;
  std::vector<diffusion::ImageEncoder> encoders_;  ///< one per thread
};

/// Features so far; rows up to `done` hold.
struct Progress {
  fs::path path;
  json key;
  FeatureCache cache;
  std::size_t done = 0;

  void load() {
    if (!fs::exists(path)) return;
    const learning::Checkpoint stored = learning::readCheckpoint(path);
    if (stored.facts.at("key") != key) return;
    const std::string source = "cache '" + path.string() + "'";
    cache.features = stored.tensor("features", cache.features.sizes(), source);
    if (cache.previous.defined()) {
      cache.previous = stored.tensor("previous", cache.previous.sizes(), source);
      cache.previous_known = stored.tensor("previous_known", cache.previous_known.sizes(), source);
    }
    done = stored.facts.at("done");
  }
  void save() const {
    learning::Checkpoint stored;
    stored.facts = json{{"key", key}, {"done", done}};
    stored.tensors = {{"features", cache.features}};
    if (cache.previous.defined()) {
      stored.tensors.insert({{"previous", cache.previous}});
      stored.tensors.insert({{"previous_known", cache.previous_known}});
    }
    learning::writeCheckpoint(path, stored);
  }
};

void computeChunk(const TrainingState& state, Encoders& encoders, Progress& progress) {
  const std::size_t end = std::min(progress.done + kChunk, state.dataset.size());
  const auto first = static_cast<std::int64_t>(progress.done);
  const auto count = static_cast<std::int64_t>(end - progress.done);
  const std::vector<learning::DrivingSample> samples = samplesOf(state, progress.done, end);
  Images images;
  for (const learning::DrivingSample& sample : samples) images.push_back(&sample.image);
  progress.cache.features.narrow(0, first, count).copy_(encoders.encode(images));
  progress.done = end;
  if (!progress.cache.previous.defined()) return;
  images.clear();
  std::vector<std::int64_t> rows;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (samples[i].previous_image.empty()) continue;
    images.push_back(&samples[i].previous_image);
    rows.push_back(first + static_cast<std::int64_t>(i));
  }
  if (images.empty()) return;
  const at::Tensor at_rows =
      learning::toIndices(rows, {static_cast<std::int64_t>(rows.size())}, at::kCPU);
  progress.cache.previous.index_copy_(0, at_rows, encoders.encode(images));
  progress.cache.previous_known.index_fill_(0, at_rows, 1.0);
}

/// Empty, or what an earlier run with the same encoder and data left.
Progress progressOf(const TrainingState& state) {
  Progress progress;
  progress.path = fs::path(state.run.options.output) / kFeatureFile;
  progress.key = {{"encoder", hashOf(state.encoder.parameters())},
                  {"data", state.run.dataset.sha256()},
                  {"mirrored_half", state.settings.mirror},
                  {"precision", inference::toText(featurePrecision(state.settings))},
                  {"previous", state.architecture.takesPrevious()}};
  const auto samples = static_cast<std::int64_t>(state.dataset.size());
  progress.cache.features = at::zeros({samples, state.architecture.image_features}, at::kFloat);
  if (state.architecture.takesPrevious()) {
    progress.cache.previous = at::zeros_like(progress.cache.features);
    progress.cache.previous_known = at::zeros({samples, 1}, at::kFloat);
  }
  progress.load();
  return progress;
}

}  // namespace

FeatureCache computeFeatures(const TrainingState& state) {
  const at::NoGradGuard no_gradient;
  Progress progress = progressOf(state);
  Encoders encoders(state);
  double saved = now();
  double reported = saved;
  const auto save = [&] {
    progress.save();
    saved = now();
  };
  const std::size_t before = progress.done;
  while (progress.done < state.dataset.size()) {
    computeChunk(state, encoders, progress);
    const double time = now();
    if (state.run.stop) {
      save();
      throw core::Interrupted("stopped while computing features; --resume goes on");
    }
    if (time - saved >= state.run.options.checkpoint_every) save();
    if (time - reported < state.run.options.report_every) continue;
    state.run.log << "features " << progress.done << "/" << state.dataset.size() << std::endl;
    reported = time;
  }
  if (progress.done != before) save();
  return progress.cache;
}

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

/// Stages from whose checkpoints the run takes weights; those that it continues come first.
std::vector<std::string> sourcesOf(const learning::TrainingOptions& options) {
  if (options.stage == "export") return {"joint", "denoiser"};
  std::vector<std::string> stages;
  if (options.resume && options.stage == "all") stages = {"encoder", "fine_tune", "denoiser"};
  if (options.resume && options.stage != "all") stages = {options.stage};
  if (options.stage == "fine_tune") stages.emplace_back("encoder");
  if (options.stage == "joint") stages.emplace_back("denoiser");
  return stages;
}

/// A fine-tuned encoder is exported with the denoiser that is there. Throws InputError where that
/// has another normalizer.
void requireDenoiserOf(const json& normalizer, const learning::TrainingOptions& options) {
  const fs::path path = learning::checkpointPath(options.output, "denoiser");
  if (options.stage != "fine_tune" || !fs::exists(path)) return;
  const json facts = learning::readCheckpoint(path).facts;
  if (!facts.contains("normalizer") || facts.at("normalizer") == normalizer) return;
  throw core::InputError("checkpoint '" + path.string() +
                         "' has another normalizer than the encoder's, with which it would be "
                         "exported; train the denoiser anew, or remove this file");
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
    requireDenoiserOf(facts.at("normalizer"), options);
    return readNormalizer(facts.at("normalizer"), path, dataset.schema().horizon);
  }
  return init != nullptr ? init->normalizer : fitNormalizer(dataset, mirror);
}

}  // namespace cdiff::planners
