// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "learning/stage_runner.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "core/text.h"
#include "e2e_cdiff/core/angle.h"
#include "learning/training_folder.h"

namespace cdiff::learning {
namespace {

namespace fs = std::filesystem;
using core::formatFixed;
using core::InputError;
using nlohmann::json;

constexpr double kLossMemory = 0.98;
constexpr std::size_t kLongestFact = 100;  // letters in a message

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::vector<at::Tensor> tensorsOf(const std::vector<TrainedPart>& parts) {
  std::vector<at::Tensor> tensors;
  for (const TrainedPart& part : parts) {
    part.parameters->setTrained(true);
    const std::vector<at::Tensor>& all = part.parameters->tensors();
    tensors.insert(tensors.end(), all.begin(), all.end());
  }
  return tensors;
}

std::string clockText(double seconds) {
  const auto whole = static_cast<std::int64_t>(std::max(0.0, seconds));
  const auto two = [](std::int64_t value) {
    return (value < 10 ? "0" : "") + std::to_string(value);
  };
  return std::to_string(whole / 3600) + ":" + two(whole / 60 % 60) + ":" + two(whole % 60);
}

}  // namespace

StageRunner::StageRunner(Stage& stage, const TrainingOptions& options, const json& facts,
                         const std::atomic<bool>& stop, std::ostream& log)
    : stage_(stage),
      options_(options),
      rules_(stage.rules()),
      facts_(facts),
      stop_(stop),
      log_(log),
      parts_(stage.parts()),
      optimizer_(tensorsOf(parts_), {options.weight_decay, options.average_decay,
                                     options.second_decay, rules_.epsilon}) {}

StageResult StageRunner::run() {
  const bool done = options_.resume && resume();
  curves_.emplace(options_.output, stage_.name(), result_.steps);
  started_ = last_report_ = last_checkpoint_ = now();
  last_report_step_ = result_.steps;
  while (!done && !finished()) {
    if (stop_ && betweenPeriods()) {
      save(false);
      throw core::Interrupted("stopped at step " + std::to_string(result_.steps) + " of stage " +
                              stage_.name() + "; --resume goes on from there");
    }
    stepOrStop();
    if (betweenPeriods() && now() - last_checkpoint_ >= options_.checkpoint_every) save(false);
    if (result_.steps % options_.validation_every == 0 && !finished()) measureHeldOut();
  }
  if (!done) {
    measureHeldOut();
    save(true);
    result_.seconds = seconds();
  }
  optimizer_.swapAverage();
  for (const TrainedPart& part : parts_) part.parameters->setTrained(false);
  return result_;
}

/// A stage that stops by itself before it has a loss leaves everything as it was.
void StageRunner::stepOrStop() {
  try {
    step();
  } catch (const core::Interrupted&) {
    if (betweenPeriods()) save(false);
    throw;
  }
}

void StageRunner::step() {
  optimizer_.clearGradients();
  const Loss loss = stage_.loss(result_.steps);
  const double value = loss.total.item<double>();
  checkFinite(value);
  loss.total.backward();
  const double norm = clip();
  checkFinite(norm);
  optimizer_.step(result_.steps, rate());
  ++result_.steps;
  result_.loss =
      result_.steps == 1 ? value : kLossMemory * result_.loss + (1.0 - kLossMemory) * value;
  noteNews();
  if (now() - last_report_ >= options_.report_every || finished()) logProgress(loss, norm);
}

/// Returns the norm before, of all parts together.
double StageRunner::clip() {
  if (!rules_.clip_apart) return optimizer_.clipGradients(options_.clip);
  double square = 0.0;
  std::size_t first = 0;
  for (const TrainedPart& part : parts_) {
    const std::size_t count = part.parameters->tensors().size();
    const double norm = optimizer_.clipGradients(options_.clip, first, count);
    square += norm * norm;
    first += count;
  }
  return std::sqrt(square);
}

/// After the step: a run that is resumed at its begin makes it again.
void StageRunner::noteNews() {
  const Measures fresh = stage_.news();
  if (fresh.empty()) return;
  curves_->add(result_.steps, seconds(), fresh);
  news_ = fresh;
}

void StageRunner::checkFinite(double value) {
  if (std::isfinite(value)) return;
  std::string text = "stage " + stage_.name() + ": the loss or its gradient is " +
                     core::formatNumber(value) + " at step " + std::to_string(result_.steps) +
                     "; the samples of its batch are";
  for (const std::size_t sample : stage_.samplesOf(result_.steps))
    text += " " + std::to_string(sample);
  if (optimizer_.parametersFinite() && betweenPeriods()) {
    save(false);
    text += "; the weights before that step are in ";
  } else {
    text += "; the last good weights are in ";
  }
  throw DivergedError(text + checkpointPath(options_.output, stage_.name()).string());
}

double StageRunner::seconds() const { return seconds_before_ + (now() - started_); }

bool StageRunner::finished() const {
  return betweenPeriods() && (result_.steps >= options_.steps ||
                              (options_.time_limit > 0.0 && seconds() >= options_.time_limit));
}

double StageRunner::progress() const {
  const double share = static_cast<double>(result_.steps) / static_cast<double>(options_.steps);
  return options_.anneal_by_time ? std::max(share, seconds() / options_.time_limit) : share;
}

double StageRunner::rate() const {
  if (const auto own = stage_.learningRate(result_.steps)) return *own;
  const double start = options_.warm_up == 0
                           ? 1.0
                           : std::min(1.0, static_cast<double>(result_.steps + 1) /
                                               static_cast<double>(options_.warm_up));
  const double done = std::min(1.0, progress());
  const double fall = rules_.linear ? 1.0 - done : 0.5 * (1.0 + std::cos(core::kPi * done));
  return options_.learning_rate * start * fall;
}

void StageRunner::record(const Loss& loss, double norm, double samples_per_second) {
  Measures measures = {{"loss", result_.loss},
                       {"gradient_norm", norm},
                       {"learning_rate", rate()},
                       {"samples_per_second", samples_per_second}};
  for (const auto& [name, term] : loss.terms) measures["loss_" + name] = term.item<double>();
  curves_->add(result_.steps, seconds(), measures);
}

/// Against what ends the stage first at this pace: its steps or the time limit.
std::string StageRunner::progressText() const {
  const std::string step = "step " + std::to_string(result_.steps);
  const double share = static_cast<double>(result_.steps) / static_cast<double>(options_.steps);
  const bool timed = options_.time_limit > 0.0 && seconds() / options_.time_limit >= share;
  if (!timed) return step + "/" + std::to_string(options_.steps);
  return step + ", " + clockText(seconds()) + " of " + clockText(options_.time_limit);
}

void StageRunner::logProgress(const Loss& loss, double norm) {
  const double elapsed = std::max(1e-9, now() - last_report_);
  const auto steps = static_cast<double>(result_.steps - last_report_step_);
  const double samples_per_second = steps * static_cast<double>(stage_.batchSize()) / elapsed;
  double left =
      static_cast<double>(options_.steps - result_.steps) * elapsed / std::max(1.0, steps);
  if (options_.time_limit > 0.0) left = std::min(left, options_.time_limit - seconds());
  log_ << stage_.name() << " " << progressText() << " loss " << formatFixed(result_.loss, 4);
  for (const auto& [name, term] : loss.terms)
    log_ << " " << name << " " << formatFixed(term.item<double>(), 4);
  for (const auto& [name, value] : news_) log_ << " " << name << " " << formatFixed(value, 3);
  log_ << " gradient " << formatFixed(norm, 2) << " rate " << formatFixed(rate() * 1e6, 1)
       << "e-6, " << formatFixed(samples_per_second, 1) << " samples/s, left " << clockText(left)
       << std::endl;
  record(loss, norm, samples_per_second);
  last_report_ = now();
  last_report_step_ = result_.steps;
}

void StageRunner::measureHeldOut() {
  optimizer_.swapAverage();
  result_.held_out = stage_.measureHeldOut();
  optimizer_.swapAverage();
  log_ << stage_.name() << " step " << result_.steps << " held out:";
  for (const auto& [name, value] : result_.held_out)
    log_ << " " << name << " " << formatFixed(value, 3);
  log_ << std::endl;
  Measures named;
  for (const auto& [name, value] : result_.held_out) named["held_out_" + name] = value;
  curves_->add(result_.steps, seconds(), named);
}

template <class Visit>
void StageRunner::visitTensors(Visit visit) {
  std::size_t i = 0;
  for (const TrainedPart& part : parts_) {
    for (const std::string& name : part.parameters->names()) {
      const std::string full = part.name + "/" + name;
      visit("weight/" + full, optimizer_.parameters()[i]);
      visit("first/" + full, optimizer_.firstMoments()[i]);
      visit("second/" + full, optimizer_.secondMoments()[i]);
      visit("average/" + full, optimizer_.averages()[i]);
      ++i;
    }
  }
}

void StageRunner::save(bool done) {
  Checkpoint checkpoint;
  checkpoint.facts = facts_;
  checkpoint.facts.update(json{{"stage", stage_.name()},
                               {"steps", result_.steps},
                               {"seconds", seconds()},
                               {"loss", result_.loss},
                               {"held_out", result_.held_out},
                               {"done", done},
                               {"seed", options_.seed},
                               {"batch", stage_.batchSize()},
                               {"planned_steps", options_.steps}});
  visitTensors(
      [&](const std::string& name, at::Tensor& tensor) { checkpoint.tensors[name] = tensor; });
  writeCheckpoint(checkpointPath(options_.output, stage_.name()), checkpoint);
  last_checkpoint_ = now();
}

void StageRunner::readFacts(const json& facts, const std::string& source) {
  json expected = facts_;
  expected.update(json{{"seed", options_.seed}, {"batch", stage_.batchSize()}});
  for (const auto& [key, value] : expected.items()) {
    if (!facts.contains(key) || facts.at(key) == value) continue;
    const std::string found = facts.at(key).dump();
    const bool short_enough = std::max(found.size(), value.dump().size()) <= kLongestFact;
    throw InputError(
        source + ": was trained with " +
        (short_enough ? key + " " + found + ", this run has " + value.dump() : "another " + key) +
        "; --resume cannot go on from it");
  }
  result_.steps = facts.at("steps");
  result_.loss = facts.at("loss").is_number() ? facts.at("loss").get<double>() : 0.0;
  result_.held_out = facts.at("held_out").get<Measures>();
  seconds_before_ = facts.at("seconds");
  result_.seconds = seconds_before_;
}

bool StageRunner::resume() {
  const fs::path path = checkpointPath(options_.output, stage_.name());
  if (!fs::exists(path)) return false;
  const std::string source = "checkpoint '" + path.string() + "'";
  const Checkpoint checkpoint = readCheckpoint(path);
  readFacts(checkpoint.facts, source);
  const at::NoGradGuard no_gradient;
  visitTensors([&](const std::string& name, at::Tensor& tensor) {
    tensor.copy_(checkpoint.tensor(name, tensor.sizes(), source));
  });
  log_ << stage_.name() << ": resumed at step " << result_.steps << std::endl;
  return checkpoint.facts.at("done") && checkpoint.facts.at("planned_steps") == options_.steps;
}

void StageRunner::loadAverage(const fs::path& path, const TrainedPart& part) {
  const at::NoGradGuard no_gradient;
  const Checkpoint checkpoint = readCheckpoint(path);
  const std::string source = "checkpoint '" + path.string() + "'";
  for (std::size_t i = 0; i < part.parameters->names().size(); ++i) {
    at::Tensor& tensor = part.parameters->tensors()[i];
    const std::string name = "average/" + part.name + "/" + part.parameters->names()[i];
    tensor.copy_(checkpoint.tensor(name, tensor.sizes(), source));
  }
}

}  // namespace cdiff::learning
