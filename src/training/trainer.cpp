// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "training/trainer.h"

#include <ATen/Context.h>
#include <ATen/Parallel.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <ostream>

#include "core/file.h"
#include "core/output_folder.h"
#include "diffusion/model.h"
#include "training/export.h"
#include "training/feature_cache.h"
#include "training/stage_runner.h"
#include "training/stored_normalizer.h"
#include "training/training_folder.h"

namespace cdiff::training {
namespace {

namespace fs = std::filesystem;
using core::InputError;

at::Device chooseDevice(const std::string& name) {
  if (name == "cuda" && !at::hasCUDA())
    throw InputError("training: device is 'cuda', but libtorch finds none");
  return at::Device(name != "cpu" && at::hasCUDA() ? at::kCUDA : at::kCPU);
}

/// bfloat16 pays only where the processor multiplies it itself.
bool halfPrecision(const std::string& precision) {
  if (precision != "auto") return precision == "bf16";
  std::ifstream file("/proc/cpuinfo");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  return text.find("avx512_bf16") != std::string::npos;
}

diffusion::Architecture architectureOf(const TrainingOptions& options, const SampleSchema& schema) {
  diffusion::Architecture architecture = options.architecture;
  architecture.horizon = schema.horizon;
  architecture.image_width = schema.image_width;
  architecture.image_height = schema.image_height;
  architecture.route_points = schema.route_points;
  architecture.route_spacing = schema.route_spacing;
  architecture.validate();
  return architecture;
}

/// The model of --init, if one is given.
std::optional<diffusion::Model> initialModel(const TrainingOptions& options,
                                             const diffusion::Architecture& architecture) {
  if (options.init.empty()) return std::nullopt;
  diffusion::Model model = diffusion::loadModel(options.init);
  if (model.architecture == architecture) return model;
  throw InputError("training: the architecture of '" + options.init + "' is " +
                   model.architecture.toJson() + ", this run has " + architecture.toJson());
}

/// Up to `count` of the validation samples, evenly spaced.
std::vector<std::size_t> chooseHeldOut(const Dataset& dataset, std::size_t count) {
  const std::vector<std::size_t>& all = dataset.validation();
  if (all.size() <= count) return all;
  std::vector<std::size_t> chosen;
  for (std::size_t i = 0; i < count; ++i) chosen.push_back(all[i * all.size() / count]);
  return chosen;
}

class Trainer {
 public:
  Trainer(const TrainingOptions& options, const Dataset& dataset, const std::atomic<bool>& stop,
          std::ostream& log)
      : options_(options),
        stop_(stop),
        log_(log),
        architecture_(architectureOf(options, dataset.schema())),
        device_(chooseDevice(options.device)),
        initial_(initialModel(options, architecture_)),
        normalizer_(chooseNormalizer(options, dataset, initial_ ? &*initial_ : nullptr)),
        state_{dataset,
               options_,
               architecture_,
               normalizer_,
               device_,
               ImageEncoderNet(architecture_, seed()),
               RegressionHead(architecture_, auxiliary(dataset), seed()),
               DenoiserNet(architecture_, seed()),
               DiffusionTask(architecture_, normalizer_, device_),
               chooseHeldOut(dataset, static_cast<std::size_t>(options.validation_samples)),
               halfPrecision(options.precision)} {
    loadInitial();
    state_.encoder.parameters().moveTo(device_);
    state_.head.parameters().moveTo(device_);
    state_.denoiser.moveTo(device_);
  }

  void run() {
    removeEarlier(options_);
    const bool all = options_.stage == "all";
    if (all || options_.stage == "encoder") trainEncoder("encoder", options_.image_scale);
    if (options_.stage == "fine_tune" || (all && options_.image_scale != 1.0))
      trainEncoder("fine_tune", 1.0);
    if (all || options_.stage == "denoiser") trainDenoiser();
    if (options_.stage == "joint") trainJoint();
    if (options_.stage == "export") {
      loadEncoder("export");
      load(denoiserSources("export"), {"denoiser", &state_.denoiser.parameters()});
    }
    if (!hasDenoiser()) {
      log_ << "no model is written yet: train stage denoiser on this encoder next" << std::endl;
      return;
    }
    gatherResults();
    exportModel(state_, results_);
    log_ << "model written to " << options_.output << std::endl;
  }

 private:
  std::uint64_t seed() const { return static_cast<std::uint64_t>(options_.seed); }
  static std::int64_t auxiliary(const Dataset& dataset) {
    return static_cast<std::int64_t>(dataset.schema().auxiliary.size());
  }

  void loadInitial() {
    if (!initial_) return;
    state_.encoder.parameters().load(initial_->encoder, options_.init);
    state_.denoiser.parameters().load(initial_->denoiser, options_.init);
    initial_.reset();
  }

  /// Loads a part from the first of the stages' checkpoints that exists; false if none does.
  bool load(const std::vector<std::string>& stages, const TrainedPart& part) {
    for (const std::string& stage : stages) {
      const fs::path path = StageRunner::pathOf(options_.output, stage);
      if (!fs::exists(path)) continue;
      StageRunner::loadAverage(path, part);
      log_ << part.name << " starts from " << path.string() << std::endl;
      return true;
    }
    return false;
  }

  void loadEncoder(const std::string& stage) {
    load(encoderSources(stage), {"encoder", &state_.encoder.parameters()});
  }

  /// Whether the model is whole: a fine-tuned encoder goes with the denoiser of an earlier run or
  /// of the initial model.
  bool hasDenoiser() {
    if (options_.stage == "encoder") return false;
    if (options_.stage != "fine_tune") return true;
    return load({"joint", "denoiser"}, {"denoiser", &state_.denoiser.parameters()}) ||
           !options_.init.empty();
  }

  void runStage(Stage& stage) {
    const nlohmann::json facts = {{"data", state_.dataset.sha256()},
                                  {"normalizer", normalizer_.toJson()}};
    StageRunner runner(stage, options_, facts, stop_, log_);
    results_[stage.name()] = runner.run();
  }

  void trainEncoder(const std::string& name, double scale) {
    if (name == "fine_tune") {
      loadEncoder(name);
      load({"encoder"}, {"head", &state_.head.parameters()});
    }
    const std::unique_ptr<Stage> stage = makeEncoderStage(state_, name, scale);
    runStage(*stage);
  }

  void trainDenoiser() {
    loadEncoder("denoiser");
    const FeatureCache cache = computeFeatures(state_, stop_, log_);
    const std::unique_ptr<Stage> stage = makeDiffusionStage(state_, "denoiser", &cache);
    runStage(*stage);
  }

  void trainJoint() {
    loadEncoder("joint");
    load({"denoiser"}, {"denoiser", &state_.denoiser.parameters()});
    const std::unique_ptr<Stage> stage = makeDiffusionStage(state_, "joint", nullptr);
    runStage(*stage);
  }

  /// What earlier runs left in checkpoints.
  void gatherResults() {
    for (const char* name : {"encoder", "fine_tune", "denoiser", "joint"}) {
      const fs::path path = StageRunner::pathOf(options_.output, name);
      if (results_.count(name) != 0 || !fs::exists(path)) continue;
      const nlohmann::json facts = readCheckpoint(path).facts;
      results_[name] = {facts.at("steps"), facts.at("seconds"), facts.at("loss"),
                        facts.at("held_out").get<Figures>()};
    }
  }

  const TrainingOptions options_;
  const std::atomic<bool>& stop_;
  std::ostream& log_;
  diffusion::Architecture architecture_;
  at::Device device_;
  std::optional<diffusion::Model> initial_;  ///< until its weights are loaded
  diffusion::Normalizer normalizer_;
  TrainingState state_;
  std::map<std::string, StageResult> results_;
};

}  // namespace

void train(const TrainingOptions& options, const std::atomic<bool>& stop, std::ostream& log) {
  options.validate();
  at::set_num_threads(static_cast<int>(options.threads));
  const core::FolderLock lock(options.output, "cdiff train");
  requireFreeOutput(options);
  requireSources(options);
  core::removeTemporaries(options.output);
  const Dataset dataset(options.data, options.validation_share);
  log << "data: " << dataset.training().size() << " training samples, "
      << dataset.validation().size() << " validation samples, " << dataset.sessions() << " sessions"
      << std::endl;
  Trainer(options, dataset, stop, log).run();
}

}  // namespace cdiff::training
