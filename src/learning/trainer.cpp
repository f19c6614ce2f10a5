// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "learning/trainer.h"

#include <ATen/Context.h>
#include <ATen/Parallel.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <ostream>
#include <sstream>

#include "core/file.h"
#include "core/output_folder.h"
#include "core/text.h"
#include "learning/export.h"
#include "learning/stage_runner.h"
#include "learning/task.h"
#include "learning/task_data.h"
#include "learning/training_folder.h"

namespace cdiff::learning {
namespace {

namespace fs = std::filesystem;
using core::formatFixed;
using nlohmann::json;

std::string processorName() {
  std::ifstream file("/proc/cpuinfo");
  std::string line;
  while (std::getline(file, line)) {
    const std::size_t colon = line.find(": ");
    if (line.rfind("model name", 0) == 0 && colon != std::string::npos)
      return line.substr(colon + 2);
  }
  return "unknown";
}

json recordOf(const TrainingRun& run, const TrainedModel& model,
              const std::map<std::string, StageResult>& results) {
  const Dataset& dataset = run.dataset;
  const TrainingOptions& options = run.options;
  json stages = json::object();
  for (const auto& [name, result] : results) {
    stages[name] = {{"steps", result.steps},
                    {"seconds", result.seconds},
                    {"loss", result.loss},
                    {"held_out", result.held_out}};
  }
  json record = {{"schema_version", 1},
                 {"data",
                  {{"sha256", dataset.sha256()},
                   {"samples", dataset.size()},
                   {"training_samples", dataset.training().size()},
                   {"validation_samples", dataset.validation().size()},
                   {"judged_samples", run.held_out.size()},
                   {dataset.unit(), dataset.sessions()},
                   {"validation_" + dataset.unit(), dataset.validationSessions()}}},
                 {"stages", stages},
                 {"held_out", model.held_out},
                 {"init", options.init},
                 {"seed", options.seed},
                 {"learning_rate", options.learning_rate},
                 {"weight_decay", options.weight_decay},
                 {"second_decay", options.second_decay},
                 {"machine", processorName()},
                 {"threads", options.threads},
                 {"device", run.device.str()},
                 {"torch", E2E_CDIFF_TORCH_VERSION}};
  record.update(model.settings);
  return record;
}

std::string dataSentence(const json& data) {
  const std::string unit = data.contains("networks") ? "networks" : "sessions";
  const json& held_out = data["validation_" + unit];
  std::ostringstream text;
  text << data["training_samples"] << " samples of " << data[unit].get<int>() - held_out.get<int>()
       << " " << unit << "; judged on " << data["judged_samples"] << " samples of " << held_out
       << " " << unit << " that it was not trained on (0 " << unit << ": on the training samples)";
  return text.str();
}

std::string modelCard(const json& facts, const TrainedModel& model) {
  std::ostringstream card;
  card << "# " << model.title << "\n\nTrained by `cdiff train` on "
       << (model.trained_on.empty() ? dataSentence(facts["data"]) : model.trained_on)
       << ".\n\n| Stage | Steps | Seconds | Loss |\n|---|---|---|---|\n";
  for (const auto& [name, stage] : facts["stages"].items()) {
    card << "| " << name << " | " << stage["steps"] << " | "
         << formatFixed(stage["seconds"].get<double>(), 0) << " | "
         << formatFixed(stage["loss"].get<double>(), 4) << " |\n";
  }
  card << "\nMachine: " << facts["machine"].get<std::string>() << ", " << facts["threads"]
       << " thread(s), device " << facts["device"].get<std::string>() << ", libtorch "
       << facts["torch"].get<std::string>() << ", seed " << facts["seed"]
       << ".\n\n## Held-out measures\n\n"
       << model.measures;
  return card.str();
}

}  // namespace

void writeModel(const TrainingRun& run, const TrainedModel& model,
                const std::map<std::string, StageResult>& results) {
  const json record = recordOf(run, model, results);
  const fs::path folder(run.options.output);
  std::map<std::string, std::string> hashes;  // of the files so far, by the key of each
  for (const WeightFile& file : model.files) {
    inference::SafetensorsFile content = file.content;
    if (file.has_record) content.metadata["training"] = record.dump();
    content.metadata.insert(hashes.begin(), hashes.end());
    const std::string hash =
        inference::writeSafetensors(folder / file.name, content, inference::TensorType::kF16);
    if (!file.hash_key.empty()) hashes[file.hash_key] = hash;
  }
  core::writeOwnFile(folder / "training.json", record.dump(2) + "\n");
  core::writeOwnFile(folder / "model_card.md", modelCard(record, model));
}

namespace {

using core::InputError;

at::Device chooseDevice(const std::string& name) {
  if (name == "cuda" && !at::hasCUDA())
    throw InputError(
        "training: device is 'cuda', but libtorch finds none here; choose 'cpu' or "
        "'auto', or build against a libtorch with CUDA");
  return at::Device(name != "cpu" && at::hasCUDA() ? at::kCUDA : at::kCPU);
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
  Trainer(const Training& training, const Dataset& dataset, const std::atomic<bool>& stop,
          std::ostream& log)
      : training_(training),
        options_(training_.options),
        task_(*training_.task),
        run_{dataset,
             options_,
             chooseDevice(options_.device),
             chooseHeldOut(dataset, static_cast<std::size_t>(options_.validation_samples)),
             stop,
             log} {}

  void run() {
    task_.start(run_);
    removeEarlier(training_);
    std::vector<std::string> stages = {options_.stage};
    if (options_.stage == "all") stages = task_.allStages();
    StageInfo last = {"export", {}, true, {}, ""};
    for (const std::string& name : stages) {
      for (const PartSource& source : sourcesOf(task_, name)) load(source);
      if (name == "export") continue;
      last = infoOf(name);
      trainStage(name);
    }
    if (!isWhole(last)) {
      run_.log << "no model is written yet: " << last.next << std::endl;
      return;
    }
    gatherResults();
    writeModel(run_, task_.finish(), results_);
    run_.log << "model written to " << options_.output << std::endl;
  }

 private:
  StageInfo infoOf(const std::string& name) const {
    for (const StageInfo& stage : task_.stages()) {
      if (stage.name == name) return stage;
    }
    throw std::logic_error("no stage " + name);
  }

  TrainedPart partNamed(const std::string& name) const {
    for (const TrainedPart& part : task_.parts()) {
      if (part.name == name) return part;
    }
    throw std::logic_error("no part " + name);
  }

  /// Loads a part from the first of the stages' checkpoints that exists; false if none does.
  bool load(const PartSource& source) {
    for (const std::string& stage : source.stages) {
      const fs::path path = checkpointPath(options_.output, stage);
      if (!fs::exists(path)) continue;
      StageRunner::loadAverage(path, partNamed(source.part));
      run_.log << source.part << " starts from " << path.string() << std::endl;
      return true;
    }
    return false;
  }

  /// Whether there is a model after the stage; loads the rest of it.
  bool isWhole(const StageInfo& last) {
    if (!last.makes_model) return false;
    return std::all_of(last.rest.begin(), last.rest.end(), [&](const PartSource& source) {
      return load(source) || !options_.init.empty();
    });
  }

  void trainStage(const std::string& name) {
    nlohmann::json facts = {{"data", run_.dataset.sha256()}, {"task", options_.task}};
    facts.update(task_.facts());
    const std::unique_ptr<Stage> stage = task_.makeStage(name);
    StageRunner runner(*stage, options_, facts, run_.stop, run_.log);
    results_[name] = runner.run();
  }

  /// What earlier runs left in checkpoints.
  void gatherResults() {
    for (const StageInfo& stage : task_.stages()) {
      const fs::path path = checkpointPath(options_.output, stage.name);
      if (results_.count(stage.name) != 0 || !fs::exists(path)) continue;
      const nlohmann::json facts = readCheckpoint(path).facts;
      results_[stage.name] = {facts.at("steps"), facts.at("seconds"), facts.at("loss"),
                              facts.at("held_out").get<Measures>()};
    }
  }

  const Training training_;
  const TrainingOptions& options_;
  Task& task_;
  TrainingRun run_;
  std::map<std::string, StageResult> results_;
};

}  // namespace

void train(const Training& training, const std::atomic<bool>& stop, std::ostream& log) {
  training.validate();
  const TrainingOptions& options = training.options;
  at::set_num_threads(static_cast<int>(options.threads));
  core::OutputFolder output(options.output, "cdiff train");
  requireFreeOutput(training);
  requireSources(training);
  output.removeUnfinished();
  if (!training.needsSamples()) {
    const Dataset none;
    Trainer(training, none, stop, log).run();
    output.requireInPlace();
    return;
  }
  const Dataset dataset = readData(training, stop, log);
  log << "data: " << dataset.training().size() << " training samples, "
      << dataset.validation().size() << " validation samples, " << dataset.sessions() << " "
      << dataset.unit() << std::endl;
  Trainer(training, dataset, stop, log).run();
  output.requireInPlace();
}

}  // namespace cdiff::learning
