// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/slurm/slurm_options.h"

#include <algorithm>
#include <iterator>

#include "core/file.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::evaluation {

namespace {

/// What the engine sets itself, by which it finds and follows its jobs.
void requireNotOurs(const std::string& argument) {
  constexpr const char* kOurs[] = {"--array",      "--job-name",  "--output", "--error",
                                   "--export",     "--open-mode", "--signal", "--parsable",
                                   "--wait",       "--test-only", "--wrap",   "--requeue",
                                   "--no-requeue", "--clusters"};
  constexpr const char* kLetters[] = {"-a", "-J", "-o", "-e", "-W", "-M"};
  const std::string name = argument.substr(0, argument.find_first_of("= "));
  const auto is = [&](const char* ours) {  // sbatch takes the beginning of a name, too
    return name.size() > 2 && std::string(ours).rfind(name, 0) == 0;
  };
  const auto begins = [&](const char* letter) { return argument.rfind(letter, 0) == 0; };
  if (std::none_of(std::begin(kOurs), std::end(kOurs), is) &&
      std::none_of(std::begin(kLetters), std::end(kLetters), begins))
    return;
  throw core::InputError("--slurm: extra_args holds '" + core::shortened(argument) +
                         "', which the engine sets itself");
}

}  // namespace

void SlurmOptions::describe(core::OptionsVisitor& visitor) {
  constexpr std::int64_t kMost = 1000000;
  visitor.text({"partition", "", "Partition of the tasks"}, partition, {});
  visitor.text({"account", "", "Account that pays"}, account, {});
  visitor.text({"qos", "", "Quality of service"}, qos, {});
  visitor.text({"time", "", "Time limit of a task, as sbatch takes it"}, time, {});
  visitor.text({"memory", "", "Memory of a task, as sbatch takes it"}, memory, {});
  visitor.text({"constraint", "", "Features that a node must have"}, constraint, {});
  visitor.integer({"nice", "", "How far the tasks step back"}, nice, 0, kMost);
  visitor.integer({"runs_per_task", "", "Runs of one array task"}, runs_per_task, 1, kMost);
  visitor.integer({"max_running", "", "Tasks at a time; 0 for no limit"}, max_running, 0, kMost);
  visitor.number({"poll", "s", "Time between two questions to Slurm"}, poll, 0.1, 3600.0);
  visitor.list({"setup", "", "Shell lines before the worker"}, setup);
  visitor.list({"extra_args", "", "Further arguments of sbatch"}, extra_args);
}

void SlurmOptions::validate() const {
  std::vector<std::string> texts = {partition, account, qos, time, memory, constraint};
  texts.insert(texts.end(), setup.begin(), setup.end());
  texts.insert(texts.end(), extra_args.begin(), extra_args.end());
  const auto is_control = [](unsigned char sign) { return sign < 0x20 || sign == 0x7f; };
  for (const std::string& text : texts) {
    if (std::any_of(text.begin(), text.end(), is_control))
      throw core::InputError(
          "--slurm: a value holds a line break or another control character; "
          "expected one line each");
  }
  for (const std::string& argument : extra_args) requireNotOurs(argument);
}

SlurmOptions slurmOptionsOf(const std::vector<std::string>& texts) {
  SlurmOptions options;
  for (const std::string& text : texts) {
    if (text.find('=') == std::string::npos) {
      core::loadOptions({text, core::readFile(text, "--slurm", core::kLargestOptionsFile)},
                        options);
    } else {
      core::overrideOption(text, "--slurm", options);
    }
  }
  options.validate();
  return options;
}

}  // namespace cdiff::evaluation
