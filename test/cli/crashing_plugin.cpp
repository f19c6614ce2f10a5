// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// A plug-in for the tests that ends or stops the program: its planner as the key quitter.end says,
/// its objective as its option says, its metric as the variable CRASHING_METRIC says. Planner and
/// metric drive and measure for a while before.
#include <class_loader/class_loader.hpp>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <string>

#include "e2e_cdiff/plugins/plugin.h"

namespace {

constexpr int kCallsBefore = 5;

void endProgram(const std::string& how) {
  if (how == "segmentation_fault") std::raise(SIGSEGV);
  if (how == "abort") std::abort();
  if (how == "exit") std::exit(0);
  for (volatile bool on = true; how == "endless" && on;) {
  }
}

struct QuitterOptions {
  std::string end = "none";

  void describe(cdiff::core::OptionsVisitor& visitor) {
    visitor.text(
        {"end", "", "How it ends the program."}, end,
        {"none", "segmentation_fault", "abort", "exit", "endless", "constructor_fault",
         "constructor_number", "constructor_exception", "constructor_endless", "validate_exit"});
  }
  void validate() const {
    if (end == "validate_exit") endProgram("exit");
  }
};

class Quitter : public cdiff::planning::Planner {
 public:
  explicit Quitter(const QuitterOptions& options) : options_(options) {
    if (options_.end == "constructor_fault") std::raise(SIGSEGV);
    if (options_.end == "constructor_number") throw 5;
    if (options_.end == "constructor_exception") throw std::runtime_error("no license");
    if (options_.end == "constructor_endless") {
      std::ofstream(std::getenv("CRASHING_MARK")) << "here";
      endProgram("endless");
    }
  }

  std::vector<cdiff::planning::PlannedAction> plan(
      const cdiff::traffic::TrafficSnapshot&,
      const std::vector<cdiff::planning::PlanningTask>& tasks) override {
    if (++calls_ > kCallsBefore) endProgram(options_.end);
    std::vector<cdiff::planning::PlannedAction> actions;
    for (const cdiff::planning::PlanningTask& task : tasks)
      actions.push_back({task.slot, task.vehicle->id, {0.6, 0.0, 0.0}, {}});
    return actions;
  }

 private:
  QuitterOptions options_;
  int calls_ = 0;
};

class QuittingObjective : public cdiff::guidance::Objective {
 public:
  void describe(cdiff::core::OptionsVisitor& visitor) override {
    visitor.text({"end", "", "How it ends the program."}, end_, {"none", "abort"});
  }
  double evaluate(const cdiff::guidance::GuidanceScene&, const cdiff::traffic::Rollout&,
                  cdiff::traffic::Rollout&) const override {
    endProgram(end_);
    return 0.0;
  }
  std::unique_ptr<Objective> clone() const override {
    return std::make_unique<QuittingObjective>(*this);
  }

 private:
  std::string end_ = "none";
};

constexpr cdiff::metrics::MeasureDefinition kCalls = {
    "crashing_calls",
    "",
    "Calls",
    "count",
    cdiff::metrics::Direction::kNeither,
    cdiff::metrics::Subject::kEgo,
    "Number of ticks.",
    "",
};

class CrashingMetric : public cdiff::metrics::Metric {
 public:
  CrashingMetric() {
    const char* end = std::getenv("CRASHING_METRIC");
    if (end != nullptr && std::string(end) == "constructor_exception")
      throw std::runtime_error(std::string(5000, 'x'));
  }
  void observe(const cdiff::metrics::MetricTick&) override {
    const char* end = std::getenv("CRASHING_METRIC");
    if (++calls_ > kCallsBefore && end != nullptr) endProgram(end);
  }
  void report(cdiff::metrics::MetricSink& sink) const override {
    sink.set(kCalls, {static_cast<double>(calls_), 1, "", ""});
  }

 private:
  int calls_ = 0;
};

class CrashingPlugin : public cdiff::plugins::Plugin {
 public:
  std::vector<cdiff::planning::PlannerDescriptor> planners() const override {
    cdiff::planning::PlannerDescriptor quitter;
    quitter.name = "quitter";
    quitter.title = "Quitter";
    quitter.help = "ends the program.";
    quitter.options = cdiff::planning::makePlannerOptions<QuitterOptions>;
    quitter.make = [](const cdiff::planning::PlannerParts& parts) {
      return std::make_unique<Quitter>(parts.options.of<QuitterOptions>());
    };
    return {quitter};
  }
  std::vector<cdiff::guidance::ObjectiveDescriptor> objectives() const override {
    return {
        {"quitting", "Ends the program.", [] { return std::make_unique<QuittingObjective>(); }}};
  }
  std::vector<cdiff::metrics::MetricDescriptor> metrics() const override {
    return {
        {"crashing_metric",
         "Ends the program.",
         {kCalls},
         [](const cdiff::metrics::MetricContext&) { return std::make_unique<CrashingMetric>(); }}};
  }
};

}  // namespace

CLASS_LOADER_REGISTER_CLASS(CrashingPlugin, cdiff::plugins::Plugin)
