// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Plug-ins for the tests: a good one, and one for each thing that can be wrong.
#include "e2e_cdiff/plugins/plugin.h"

#include <class_loader/class_loader.hpp>
#include <cstdlib>
#include <stdexcept>

namespace {

struct Options {
  double value = 1.0;
  void describe(cdiff::core::OptionsVisitor& visitor) {
    visitor.number({"value", "", "A value."}, value, 0.0, 2.0);
  }
  void validate() const {}
};

#ifdef PLUGIN_profile_key

class Nothing : public cdiff::guidance::Objective {
 public:
  void describe(cdiff::core::OptionsVisitor&) override {}
  double evaluate(const cdiff::guidance::GuidanceScene&, const cdiff::traffic::Rollout&,
                  cdiff::traffic::Rollout&) const override {
    return 0.0;
  }
  std::unique_ptr<Objective> clone() const override { return std::make_unique<Nothing>(*this); }
};

#endif

class Thrower : public cdiff::planning::Planner {
 public:
  std::vector<cdiff::planning::PlannedAction> plan(
      const cdiff::traffic::TrafficSnapshot&,
      const std::vector<cdiff::planning::PlanningTask>&) override {
    throw std::runtime_error("nothing can be planned here");
  }
};

[[maybe_unused]] cdiff::planning::PlannerDescriptor thrower(const std::string& name) {
  cdiff::planning::PlannerDescriptor descriptor;
  descriptor.name = name;
  descriptor.title = "Thrower";
  descriptor.help = "throws.";
  descriptor.options = cdiff::planning::makePlannerOptions<Options>;
  descriptor.make = [](const cdiff::planning::PlannerParts&) {
    return std::make_unique<Thrower>();
  };
  return descriptor;
}

#ifndef PLUGIN_empty

class TestPlugin : public cdiff::plugins::Plugin {
 public:
#if defined(PLUGIN_throwing_constructor)
  TestPlugin() { throw std::runtime_error("no license found"); }
#elif defined(PLUGIN_throwing_number)
  TestPlugin() { throw 5; }
#elif defined(PLUGIN_aborting)
  TestPlugin() { std::abort(); }
#elif defined(PLUGIN_leaving)
  TestPlugin() { std::exit(0); }
#endif
  std::vector<cdiff::planning::PlannerDescriptor> planners() const override {
#if defined(PLUGIN_throwing_list)
    throw std::runtime_error("no planner today");
#elif defined(PLUGIN_taken_name)
    return {thrower("pdm_lite")};
#elif defined(PLUGIN_profile_key)
    return {};
#elif defined(PLUGIN_scenario_key)
    return {thrower("camera")};
#elif defined(PLUGIN_no_options)
    cdiff::planning::PlannerDescriptor descriptor = thrower("bare");
    descriptor.options = nullptr;
    return {descriptor};
#else
    return {thrower("thrower")};
#endif
  }
#ifdef PLUGIN_profile_key
  std::vector<cdiff::guidance::ObjectiveDescriptor> objectives() const override {
    return {{ "trust_region", "Does nothing.", [] { return std::make_unique<Nothing>(); } }};
  }
#endif
};

#endif

}  // namespace

#ifdef PLUGIN_empty
extern "C" const void* unusedPlanner() {
  static const auto descriptor = thrower("unused");
  return &descriptor;
}
#else
CLASS_LOADER_REGISTER_CLASS(TestPlugin, cdiff::plugins::Plugin)
#endif
