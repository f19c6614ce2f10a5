// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "feature_cache.h"

#include <algorithm>
#include <chrono>

#include "checkpoint.h"
#include "e2e_cdiff/core/file.h"
#include "e2e_cdiff/core/text.h"

namespace cdiff::training {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::size_t kChunk = 32;

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::string hashOf(const ParameterSet& parameters) {
  core::Sha256 digest;
  for (const at::Tensor& tensor : parameters.tensors()) {
    const at::Tensor plain = tensor.detach().to(at::kCPU).contiguous();
    digest.update({static_cast<const char*>(plain.data_ptr()),
                   static_cast<std::size_t>(plain.numel()) * sizeof(float)});
  }
  return digest.finish();
}

at::Tensor encode(const TrainingState& state, std::size_t begin, std::size_t end, bool mirrored) {
  std::vector<traffic::CameraImage> images;
  for (std::size_t i = begin; i < end; ++i) {
    Sample sample = state.dataset.sample(i);
    if (mirrored) mirrorSample(state.dataset.schema(), sample);
    images.push_back(std::move(sample.image));
  }
  std::vector<const traffic::CameraImage*> views;
  for (const traffic::CameraImage& image : images) views.push_back(&image);
  return state.encoder.forward(imageTensor(views, 1.0, state.device)).to(at::kCPU);
}

/// Features so far; rows up to `done` hold.
struct Progress {
  fs::path path;
  json key;
  FeatureCache cache;
  std::size_t done = 0;

  void load() {
    if (!fs::exists(path)) return;
    const Checkpoint stored = readCheckpoint(path);
    if (stored.facts.at("key") != key) return;
    const std::string source = "cache '" + path.string() + "'";
    cache.original = stored.tensor("original", cache.original.sizes(), source);
    cache.mirrored = stored.tensor("mirrored", cache.mirrored.sizes(), source);
    done = stored.facts.at("done");
  }
  void save() const {
    Checkpoint stored;
    stored.facts = json{{"key", key}, {"done", done}};
    stored.tensors = {{"original", cache.original}, {"mirrored", cache.mirrored}};
    writeCheckpoint(path, stored);
  }
};

void computeChunk(const TrainingState& state, Progress& progress) {
  const std::size_t end = std::min(progress.done + kChunk, state.dataset.size());
  const auto first = static_cast<std::int64_t>(progress.done);
  const auto count = static_cast<std::int64_t>(end - progress.done);
  progress.cache.original.narrow(0, first, count).copy_(encode(state, progress.done, end, false));
  if (state.options.mirror)
    progress.cache.mirrored.narrow(0, first, count).copy_(encode(state, progress.done, end, true));
  progress.done = end;
}

}  // namespace

FeatureCache computeFeatures(const TrainingState& state, const std::atomic<bool>& stop,
                             std::ostream& log) {
  const at::NoGradGuard no_gradient;
  const auto samples = static_cast<std::int64_t>(state.dataset.size());
  const std::int64_t width = state.architecture.image_features;
  Progress progress;
  progress.path = fs::path(state.options.output) / "features.cache";
  progress.key = {{"encoder", hashOf(state.encoder.parameters())},
                  {"data", state.dataset.sha256()},
                  {"mirror", state.options.mirror}};
  progress.cache.original = at::zeros({samples, width}, at::kFloat);
  progress.cache.mirrored = at::zeros({state.options.mirror ? samples : 0, width}, at::kFloat);
  progress.load();
  double saved = now();
  double reported = saved;
  const auto save = [&] {
    progress.save();
    saved = now();
  };
  const std::size_t before = progress.done;
  while (progress.done < state.dataset.size()) {
    computeChunk(state, progress);
    const double time = now();
    if (stop) {
      save();
      throw core::Interrupted("stopped while computing features; --resume goes on");
    }
    if (time - saved >= state.options.checkpoint_every) save();
    if (time - reported < state.options.report_every) continue;
    log << "features " << progress.done << "/" << state.dataset.size() << std::endl;
    reported = time;
  }
  if (progress.done != before) save();
  return progress.cache;
}

}  // namespace cdiff::training
