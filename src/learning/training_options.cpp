// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "learning/training_options.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <sstream>

#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "learning/task.h"

namespace cdiff::learning {
namespace {

using core::InputError;
using core::OptionsVisitor;

constexpr std::int64_t kMost = 1000000000;  // steps or samples
constexpr double kLongest = 1e7;            // [s]

/// The stages of the task, then `export` and `all`.
std::vector<std::string> stageNames(const Task& task) {
  std::vector<std::string> names;
  for (const StageInfo& stage : task.stages()) names.push_back(stage.name);
  names.insert(names.end(), {"export", "all"});
  return names;
}

void describeRun(Training& training, OptionsVisitor& visitor) {
  TrainingOptions& options = training.options;
  const TaskTexts texts = training.task->texts();
  const std::string stage = "Stage to train; all: " + texts.all + ".";
  const std::string batch = "Samples a step; 0: " + texts.batch + ".";
  visitor.text({"task", "", "What to train; it decides on the stages and on further options."},
               options.task, training.tasks);
  visitor.text({"stage", "", stage.c_str()}, options.stage, stageNames(*training.task));
  const bool scenes = !training.task->sceneFields().fields.empty();
  visitor.text({"data", "", scenes ? "Folder with *.scene." : "Folder with *.shard."}, options.data,
               {});
  visitor.text({"output", "", "Folder for checkpoints and the model."}, options.output, {});
  visitor.text({"init", "", "Model to start from where no checkpoint is."}, options.init, {});
  visitor.integer({"steps", "", "Steps of the stage."}, options.steps, 1, kMost);
  visitor.integer({"batch", "", batch.c_str()}, options.batch, 0, kMost);
  visitor.integer({"threads", "", "Threads that compute."}, options.threads, 1, 256);
  visitor.integer({"seed", "", "Root seed of weights, samples and noise."}, options.seed, 0,
                  2147483647);
  visitor.flag({"resume", "", "Go on from the stage's checkpoint if there is one."},
               options.resume);
  visitor.flag({"overwrite", "", "Replace an earlier training of the stage in the folder."},
               options.overwrite);
  visitor.text({"device", "", "Where to compute."}, options.device, {"auto", "cpu", "cuda"});
}

void describeTimes(TrainingOptions& options, OptionsVisitor& visitor) {
  visitor.number(
      {"time_limit", "s",
       "Time for the steps of the stage, resumptions included; computing features and the "
       "last judgment come on top; 0: none."},
      options.time_limit, 0.0, kLongest);
  visitor.flag({"anneal_by_time", "", "The learning rate falls to 0 at the time limit."},
               options.anneal_by_time);
  visitor.number({"checkpoint_every", "s", "Between two checkpoints."}, options.checkpoint_every,
                 0.0, kLongest);
  visitor.number({"report_every", "s", "Between two lines of progress."}, options.report_every, 0.0,
                 kLongest);
}

void describeValidation(TrainingOptions& options, OptionsVisitor& visitor) {
  visitor.number({"validation_share", "",
                  "Share of the sessions that is held out, one at least; 0: none, and the training "
                  "samples judge."},
                 options.validation_share, 0.0, 0.9);
  visitor.integer({"validation_samples", "", "Held-out samples that judge, at most."},
                  options.validation_samples, 1, kMost);
  visitor.integer({"validation_every", "", "Steps between two judgments."},
                  options.validation_every, 1, kMost);
}

void describeOptimizer(TrainingOptions& options, OptionsVisitor& visitor) {
  visitor.number({"learning_rate", "", "Learning rate after the warm-up."}, options.learning_rate,
                 1e-9, 1.0);
  visitor.number({"weight_decay", "", "Weight decay of AdamW, on matrices."}, options.weight_decay,
                 0.0, 1.0);
  visitor.number({"second_decay", "", "Decay of AdamW's mean of squared gradients."},
                 options.second_decay, 0.5, 0.99999);
  visitor.integer({"warm_up", "", "Steps over which the learning rate rises."}, options.warm_up, 0,
                  kMost);
  visitor.number({"clip", "", "Largest norm of the gradient."}, options.clip, 1e-6, 1e6);
  visitor.number({"average_decay", "", "Decay of the moving average of the weights, at most."},
                 options.average_decay, 0.0, 1.0);
}

}  // namespace

void Training::describe(OptionsVisitor& visitor) {
  describeRun(*this, visitor);
  describeTimes(options, visitor);
  describeValidation(options, visitor);
  describeOptimizer(options, visitor);
  task->describe(visitor);
}

void Training::validate() const {
  Training checked = *this;
  core::loadOptions({"training options", core::dumpOptions(*this)}, checked);
  if (options.data.empty() && needsSamples())
    throw InputError("training: data, the folder of the samples, is not given");
  if (!options.data.empty() && !needsSamples()) {
    throw InputError("training: data is '" + options.data + "', but task '" + options.task +
                     "' makes its samples itself; leave --data out");
  }
  if (options.output.empty())
    throw InputError("training: output, the folder to write to, is not given");
  if (options.resume && options.overwrite) {
    throw InputError(
        "training: resume and overwrite are both set; expected one of them: go on with the "
        "training in the folder, or replace it");
  }
  if (options.anneal_by_time && options.time_limit <= 0.0)
    throw InputError("training: anneal_by_time needs a time_limit");
  task->validate();
}

bool Training::needsSamples() const { return task->needsSamples(); }

namespace {

using core::FieldInfo;

std::string optionName(const std::string& key) {
  std::string name = "--" + key;
  std::replace(name.begin(), name.end(), '_', '-');
  return name;
}

/// "Between two checkpoints [s]".
std::string helpOf(const FieldInfo& info, const std::vector<std::string>& choices = {}) {
  std::string help = info.text;
  if (!help.empty() && help.back() == '.') help.pop_back();
  if (*info.unit != '\0') help += " [" + std::string(info.unit) + "]";
  return choices.empty() ? help : help + " (" + core::joinText(choices, " | ") + ")";
}

/// "Mirror samples" -> "Do not mirror samples".
std::string refusal(std::string help) {
  help.front() = static_cast<char>(std::tolower(static_cast<unsigned char>(help.front())));
  return "Do not " + help;
}

class OptionAdder : public core::OptionsVisitor {
 public:
  OptionAdder(CLI::App& program, Training& training) : program_(program), training_(training) {}

  void number(const FieldInfo& info, double& value, double, double) override {
    std::ostringstream text;
    text << value;
    addChecked(info, helpOf(info), "FLOAT", text.str());
  }
  void integer(const FieldInfo& info, std::int64_t& value, std::int64_t, std::int64_t) override {
    addChecked(info, helpOf(info), "INT", std::to_string(value));
  }
  void text(const FieldInfo& info, std::string& value,
            const std::vector<std::string>& choices) override {
    if (!choices.empty()) return addChecked(info, helpOf(info, choices), "TEXT", value);
    program_.add_option(optionName(info.key), value, helpOf(info))->default_str(value);
  }
  void flag(const FieldInfo& info, bool& value) override {
    const bool normally = value;
    const auto set = [&value, normally](std::int64_t count) {
      value = count > 0 ? !normally : normally;
    };
    if (!normally) program_.add_flag_function(optionName(info.key), set, helpOf(info));
    if (normally)
      program_.add_flag_function(optionName("no-" + std::string(info.key)), set,
                                 refusal(helpOf(info)));
  }
  void list(const FieldInfo& info, std::vector<std::string>& value) override {
    program_.add_option(optionName(info.key), value, helpOf(info))->delimiter(',');
  }
  void points(const FieldInfo&, std::vector<Eigen::Vector3d>&) override {}  // none has any
  bool enter(const FieldInfo&) override { return true; }
  void leave() override {}

 private:
  /// What is given is checked as any other text that sets this key.
  void addChecked(const FieldInfo& info, const std::string& help, const char* type,
                  const std::string& value) {
    const std::string name = optionName(info.key);
    const auto set = [&training = training_, name,
                      key = std::string(info.key)](const std::string& text) {
      core::overrideOption(key + "=" + text, "option " + name, training);
    };
    program_.add_option_function<std::string>(name, set, help)->type_name(type)->default_str(value);
  }

  CLI::App& program_;
  Training& training_;
};

}  // namespace

void addOptions(CLI::App& program, Training& training) {
  OptionAdder adder(program, training);
  training.describe(adder);
}

}  // namespace cdiff::learning
