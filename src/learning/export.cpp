// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "learning/export.h"

#include <fstream>
#include <sstream>

#include "core/file.h"
#include "core/text.h"

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
                   {"sessions", dataset.sessions()},
                   {"validation_sessions", dataset.validationSessions()}}},
                 {"stages", stages},
                 {"held_out", model.held_out},
                 {"init", options.init},
                 {"seed", options.seed},
                 {"learning_rate", options.learning_rate},
                 {"weight_decay", options.weight_decay},
                 {"machine", processorName()},
                 {"threads", options.threads},
                 {"device", run.device.str()},
                 {"torch", E2E_CDIFF_TORCH_VERSION}};
  record.update(model.settings);
  return record;
}

std::string modelCard(const json& facts, const TrainedModel& model) {
  std::ostringstream card;
  card << "# " << model.title << "\n\nTrained by `cdiff train` on "
       << facts["data"]["training_samples"] << " samples of "
       << facts["data"]["sessions"].get<int>() - facts["data"]["validation_sessions"].get<int>()
       << " sessions; judged on " << facts["data"]["judged_samples"] << " samples of "
       << facts["data"]["validation_sessions"]
       << " sessions that it was not trained on (0 sessions: on the training samples).\n\n"
          "| Stage | Steps | Seconds | Loss |\n|---|---|---|---|\n";
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
  core::writeFileAtomically(folder / "training.json", record.dump(2) + "\n");
  core::writeFileAtomically(folder / "model_card.md", modelCard(record, model));
}

}  // namespace cdiff::learning
