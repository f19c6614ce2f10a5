// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "training/export.h"

#include <fstream>
#include <sstream>

#include "core/file.h"
#include "core/text.h"
#include "diffusion/model.h"

namespace cdiff::training {
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

json factsOf(const TrainingState& state, const std::map<std::string, StageResult>& results,
             const Figures& held_out) {
  const Dataset& dataset = state.dataset;
  json stages = json::object();
  for (const auto& [name, result] : results) {
    stages[name] = {{"steps", result.steps},
                    {"seconds", result.seconds},
                    {"loss", result.loss},
                    {"held_out", result.held_out}};
  }
  return {{"schema_version", 1},
          {"data",
           {{"sha256", dataset.sha256()},
            {"samples", dataset.size()},
            {"training_samples", dataset.training().size()},
            {"validation_samples", dataset.validation().size()},
            {"judged_samples", state.held_out.size()},
            {"sessions", dataset.sessions()},
            {"validation_sessions", dataset.validationSessions()}}},
          {"stages", stages},
          {"held_out", held_out},
          {"init", state.options.init},
          {"seed", state.options.seed},
          {"balance", state.options.balance},
          {"yielding_share", state.options.yielding_share},
          {"learning_rate", state.options.learning_rate},
          {"weight_decay", state.options.weight_decay},
          {"route_drop", state.options.route_drop},
          {"mirror", state.options.mirror},
          {"machine", processorName()},
          {"threads", state.options.threads},
          {"precision", state.half_precision ? "bf16" : "f32"},
          {"device", state.device.str()},
          {"torch", E2E_CDIFF_TORCH_VERSION}};
}

std::string figureRow(const std::string& label, const std::string& prefix, const Figures& figures) {
  std::string row = "| " + label + " |";
  for (const char* name : {"ade_m", "fde_m", "speed_mps", "throttle", "steer", "brake"}) {
    const auto found = figures.find(prefix + name);
    row += " " + (found == figures.end() ? "-" : formatFixed(found->second, 3)) + " |";
  }
  return row + "\n";
}

std::string modelCard(const json& facts, const Figures& held_out) {
  std::ostringstream card;
  card << "# Diffusion planner\n\nTrained by `cdiff train` on " << facts["data"]["training_samples"]
       << " samples of "
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
       << ".\n\n## Held-out figures\n\nMean absolute errors against the recorded rollouts: ADE and "
          "FDE [m], speed [m/s], actions as they are.\n\n"
          "| Prediction | ADE | FDE | speed | throttle | steer | brake "
          "|\n|---|---|---|---|---|---|---|\n"
       << figureRow("one step from k = K/2", "one_step_half_", held_out)
       << figureRow("one step from noise, k = K", "one_step_noise_", held_out)
       << figureRow("DDIM sample", "sample_", held_out)
       << figureRow("DDIM sample, grey image", "sample_grey_", held_out)
       << figureRow("DDIM sample, no route", "sample_no_route_", held_out)
       << figureRow("DDIM sample, grey image, no route", "sample_grey_no_route_", held_out);
  return card.str();
}

}  // namespace

void exportModel(const TrainingState& state, const std::map<std::string, StageResult>& results) {
  const HeldOut held_out = encodeHeldOut(state);
  const Figures figures = state.task.judge(state.denoiser, held_out.batch, held_out.grey_features);
  const json facts = factsOf(state, results, figures);
  diffusion::Model model;
  model.architecture = state.architecture;
  model.normalizer = state.normalizer;
  model.spread = state.task.spread(state.denoiser, held_out.batch);
  model.encoder = state.encoder.parameters().values();
  model.denoiser = state.denoiser.parameters().values();
  const fs::path folder(state.options.output);
  diffusion::saveModel(model, folder, inference::TensorType::kF16, {{"training", facts.dump()}});
  core::writeFileAtomically(folder / "training.json", facts.dump(2) + "\n");
  core::writeFileAtomically(folder / "model_card.md", modelCard(facts, figures));
}

}  // namespace cdiff::training
