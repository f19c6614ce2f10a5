// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/ppo/training/ppo_task.h"

#include <filesystem>
#include <optional>

#include "core/csv.h"
#include "core/file.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "learning/task_registry.h"
#include "planners/ppo/training/advantages.h"
#include "planners/ppo/training/ppo_stage.h"

namespace cdiff::planners {
namespace {

using core::formatFixed;
using core::InputError;

constexpr const char* kReturn = "episode_return";

void describeCollector(PpoCollectorOptions& options, core::OptionsVisitor& visitor) {
  visitor.integer(
      {"environments", "", "Sessions side by side; the weights depend on their number."},
      options.environments, 1, 256);
  visitor.integer({"workers", "", "Threads that drive sessions; the weights do not depend on it."},
                  options.workers, 1, 256);
  visitor.integer({"buffer", "", "Decisions of an iteration."}, options.buffer, 2, 1000000);
  visitor.text({"simulator", "",
                "Background traffic: in this process, or by SUMO, some ten times as slow and with "
                "one worker."},
               options.simulator, {"lanes", "sumo"});
}

/// The mean returns of the iterations so far, from the curves in the output folder.
std::vector<double> courseOf(const std::string& output) {
  constexpr std::size_t kColumns = 5;
  const std::filesystem::path file = std::filesystem::path(output) / "curves.csv";
  std::vector<double> course;
  if (!core::isFile(file)) return course;
  const std::string text = core::readFile(file, "training curves");
  for (const core::CsvRow& row : core::csvRows(text)) {
    const std::vector<std::string> cells = core::csvCells(row.text);
    if (!row.ended || cells.size() != kColumns) continue;
    if (cells[0] != PpoStage::kStage || cells[3] != kReturn) continue;
    course.push_back(core::parseNumber(cells[4]).value_or(0.0));
  }
  return course;
}

/// First against last tenth of the iterations; nullopt with fewer than 20.
std::optional<PpoDifference> riseOf(const std::vector<double>& course) {
  constexpr std::size_t kFewest = 20;
  if (course.size() < kFewest) return std::nullopt;
  const auto tenth = static_cast<std::ptrdiff_t>(course.size() / 10);
  return ppoDifference({course.begin(), course.begin() + tenth},
                       {course.end() - tenth, course.end()});
}

std::string riseText(const PpoDifference& rise) {
  return "mean return of the iterations: first tenth " + formatFixed(rise.first, 2) +
         ", last tenth " + formatFixed(rise.second, 2) + ", difference " +
         formatFixed(rise.second - rise.first, 2) + ", 95 % interval [" + formatFixed(rise.low, 2) +
         ", " + formatFixed(rise.high, 2) + "]";
}

}  // namespace

void PpoTask::setDefaults(learning::TrainingOptions& options) const {
  options.steps = 64000;  // 1000 iterations
  options.learning_rate = 3e-4;
  options.weight_decay = 0.0;
  options.warm_up = 0;
  options.clip = 0.5;
  options.average_decay = 0.0;
  options.validation_every = 3200;
  options.checkpoint_every = 0.0;
}

void PpoTask::describe(core::OptionsVisitor& visitor) {
  visitor.text({"suite", "", "Route suite to learn on, a folder that 'cdiff suite train' made."},
               settings_.suite, {});
  describeCollector(settings_.collector, visitor);
  visitor.integer({"cbvs", "", "CBVs driven at a time in a session."}, settings_.cbvs, 1, 64);
  visitor.integer({"passes", "", "Passes over the buffer of an iteration."}, settings_.passes, 1,
                  1000);
  visitor.number({"discount", "", "Discount of the next decision's return."}, settings_.discount,
                 0.0, 1.0);
  visitor.number({"advantage_decay", "", "Lambda of generalized advantage estimation."},
                 settings_.advantage_decay, 0.0, 1.0);
  visitor.number({"clip_ratio", "", "Bound of the change of a density in an iteration."},
                 settings_.clip_ratio, 0.0, 1.0);
  visitor.number({"entropy_weight", "", "Weight of the entropy in the loss."},
                 settings_.entropy_weight, 0.0, 10.0);
  visitor.integer({"held_out_rounds", "", "Sessions on each route of held-out networks."},
                  settings_.held_out_rounds, 1, 1000);
}

void PpoTask::validate() const {
  if (settings_.suite.empty()) {
    throw InputError(
        "training: suite, the route suite to learn on, is not given; make one with 'cdiff suite "
        "train --results FOLDER'");
  }
  const PpoCollectorOptions& collector = settings_.collector;
  if (collector.simulator == "sumo" && collector.workers != 1) {
    throw InputError("training: simulator sumo needs workers 1, found " +
                     std::to_string(collector.workers) + ": a process has one connection to SUMO");
  }
}

void PpoTask::start(const learning::TrainingRun& run) {
  const auto seed = static_cast<std::uint64_t>(run.options.seed);
  routes_.emplace(settings_.suite, run.options.validation_share, settings_.cbvs);
  training_.reset();
  training_.emplace(PpoTraining{run, settings_, *routes_, PpoNetworks(seed)});
  PpoNetworks& networks = training_->networks;
  if (!run.options.init.empty())
    networks.load(PpoActor::readWeights(run.options.init), run.options.init);
  networks.actor().moveTo(run.device);
  networks.critic().moveTo(run.device);
  run.log << sentence() << std::endl;
}

/// What it learns on.
std::string PpoTask::sentence() const {
  const std::size_t trained = routes_->networks() - routes_->heldOutNetworks();
  return std::to_string(routes_->training().size()) + " routes on " + std::to_string(trained) +
         " networks of the suite '" + routes_->suiteName() + "'; judged on " +
         std::to_string(routes_->heldOut().size()) + " routes on " +
         std::to_string(routes_->heldOutNetworks()) +
         " networks that it was not trained on (0 networks: on the training routes)";
}

nlohmann::json PpoTask::facts() const {
  const PpoCollectorOptions& collector = settings_.collector;
  return {{"suite_sha256", routes_->sha256()},
          {"environments", collector.environments},
          {"buffer", collector.buffer},
          {"simulator", collector.simulator},
          {"cbvs", settings_.cbvs},
          {"passes", settings_.passes},
          {"discount", settings_.discount},
          {"advantage_decay", settings_.advantage_decay},
          {"clip_ratio", settings_.clip_ratio},
          {"entropy_weight", settings_.entropy_weight},
          {"validation_share", training_->run.options.validation_share}};
}

std::string PpoTask::measuresText(const learning::Measures& held_out) const {
  std::string text = "One session on each held-out route, " +
                     std::to_string(settings_.held_out_rounds) + " time(s), actions tanh(mean), " +
                     "traffic by " + settings_.collector.simulator +
                     ".\n\n| Measure of an episode | Value |\n|---|---|\n";
  for (const auto& [name, value] : held_out)
    text += "| " + name + " | " + formatFixed(value, 3) + " |\n";
  const auto rise = riseOf(courseOf(training_->run.options.output));
  if (rise) text += "\nTraining: " + riseText(*rise) + ".\n";
  return text;
}

learning::TrainedModel PpoTask::finish() {
  learning::TrainedModel model;
  model.files = {{kPpo.file, {{{"format", kPpo.format}}, training_->networks.weights()}, true, ""}};
  model.held_out = PpoStage(*training_).measureHeldOut();
  model.settings = facts();
  model.settings["data"] = {
      {"suite", routes_->suiteName()},        {"sha256", routes_->sha256()},
      {"routes", routes_->training().size()}, {"held_out_routes", routes_->heldOut().size()},
      {"networks", routes_->networks()},      {"held_out_networks", routes_->heldOutNetworks()}};
  model.title = "PPO";
  model.trained_on = sentence();
  model.measures = measuresText(model.held_out);
  const auto rise = riseOf(courseOf(training_->run.options.output));
  if (rise) {
    training_->run.log << riseText(*rise) << std::endl;
    model.settings["rise"] = {{"first_tenth", rise->first},
                              {"last_tenth", rise->second},
                              {"low", rise->low},
                              {"high", rise->high}};
  }
  return model;
}

learning::TaskDescriptor ppoTraining() {
  return {"ppo", "Train the CBV planner ppo in sessions of its own",
          []() -> std::shared_ptr<learning::Task> { return std::make_shared<PpoTask>(); }};
}

}  // namespace cdiff::planners
