// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "learning/task.h"

#include "e2e_cdiff/core/exceptions.h"
#include "learning/task_registry.h"

namespace cdiff::learning {

using core::InputError;

void Loss::add(const std::string& name, const at::Tensor& term) {
  total = total.defined() ? total + term : term;
  for (auto& [known, value] : terms) {
    if (known != name) continue;
    value = value + term.detach();
    return;
  }
  terms.emplace_back(name, term.detach());
}

EvenStage::EvenStage(const TrainingRun& run, const std::string& name, const TrainedPart& part,
                     std::int64_t batch, const std::string& order)
    : name_(name),
      part_(part),
      batch_(run.batchSize(batch)),
      order_(run.dataset.training(), std::vector<double>(run.dataset.training().size(), 1.0),
             batch_, run.stream(order)) {}

std::vector<PartSource> OneStageTask::model() const {
  std::vector<PartSource> sources;
  for (const auto& [part, what] : parts_) sources.push_back({part, what, {stage_}, stage_});
  return sources;
}

std::vector<std::string> OneStageTask::fields() const {
  std::vector<std::string> names;
  for (const FieldSpec& field : sceneFields().fields) names.push_back(field.name);
  return names;
}

void TaskRegistry::add(const TaskDescriptor& descriptor) {
  const std::string source = "a descriptor in planners/NAME/training";
  if (descriptor.make == nullptr)
    throw InputError(source + ": training task '" + descriptor.name + "' has no constructor");
  tasks_.add(descriptor, source);
}

const TaskDescriptor& TaskRegistry::descriptor(const std::string& name) const {
  if (tasks_.entries().empty()) {
    throw InputError(
        "no training task is registered; the program that trains must add the descriptors of "
        "planners/NAME/training");
  }
  return name.empty() ? tasks_.entries().front() : tasks_.at(name);
}

Training TaskRegistry::training(const std::string& name) const {
  const TaskDescriptor& task = descriptor(name);
  Training training;
  training.options.task = task.name;
  training.task = task.make();
  training.task->setDefaults(training.options);
  training.tasks = names();
  return training;
}

}  // namespace cdiff::learning
