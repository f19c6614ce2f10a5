// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "guidance/objective_registry.h"

#include <utility>

#include "core/forked_work.h"
#include "core/registry.h"
#include "e2e_cdiff/core/exceptions.h"
#include "guidance/collision_avoidance_objective.h"
#include "guidance/collision_seeking_objective.h"
#include "guidance/comfort_objective.h"
#include "guidance/drivable_area_objective.h"
#include "guidance/route_objective.h"
#include "guidance/speed_objective.h"
#include "guidance/traffic_avoidance_objective.h"
#include "guidance/yielding_objective.h"

namespace cdiff::guidance {
namespace {

using core::InputError;

constexpr const char* kKind = "guidance objective";

template <class Kind>
std::unique_ptr<Objective> make() {
  return std::make_unique<Kind>();
}

/// The objectives of this package, in the order of profiles and reports: a new one is one more row.
std::vector<ObjectiveDescriptor> packageObjectives() {
  return {
      {"speed", "Drives at the target speed.", make<SpeedObjective>},
      {"drivable_area", "Stays inside the drivable area.", make<DrivableAreaObjective>},
      {"collision_avoidance", "Keeps away from the other vehicle.",
       make<CollisionAvoidanceObjective>},
      {"collision_seeking", "Approaches the other vehicle once it is near.",
       make<CollisionSeekingObjective>},
      {"traffic_avoidance", "Keeps away from the vehicles around but the other one.",
       make<TrafficAvoidanceObjective>},
      {"yielding", "Gives way to vehicles that cross its route.", make<YieldingObjective>},
      {"route", "Stays near the route.", make<RouteObjective>},
      {"comfort", "Moves the pedals and turns gently.", make<ComfortObjective>},
  };
}

using Registry = core::Registry<ObjectiveDescriptor>;

/// Never destroyed: it holds functions of plug-ins, whose libraries may be unloaded before.
Registry& table() {
  static Registry& objectives = *new Registry(kKind, packageObjectives());
  return objectives;
}

std::unique_ptr<Objective> requireMade(const std::string& name,
                                       std::unique_ptr<Objective> objective) {
  if (objective) return objective;
  throw InputError(kKind + (" '" + name) + "' of " + table().sourceOf(name) +
                   ": its constructor or clone() gives none; its author must mend it");
}

/// An objective of a plug-in, whose calls are named to whoever waits for this process.
class ForeignObjective : public Objective {
 public:
  ForeignObjective(std::string name, std::unique_ptr<Objective> objective)
      : name_(std::move(name)), objective_(std::move(objective)) {}
  ~ForeignObjective() override {
    const core::NamedCall call(kKind, name_);
    objective_.reset();
  }

  void describe(core::OptionsVisitor& visitor) override {
    const core::NamedCall call(kKind, name_);
    objective_->describe(visitor);
  }
  void validate() const override {
    const core::NamedCall call(kKind, name_);
    objective_->validate();
  }
  void prepare(const GuidanceScene& scene) override {
    const core::NamedCall call(kKind, name_);
    objective_->prepare(scene);
  }
  double evaluate(const GuidanceScene& scene, const traffic::Rollout& rollout,
                  traffic::Rollout& gradient) const override {
    const core::NamedCall call(kKind, name_);
    return objective_->evaluate(scene, rollout, gradient);
  }
  std::unique_ptr<Objective> clone() const override {
    const core::NamedCall call(kKind, name_);
    return std::make_unique<ForeignObjective>(name_, requireMade(name_, objective_->clone()));
  }

 private:
  std::string name_;
  std::unique_ptr<Objective> objective_;
};

}  // namespace

void registerObjective(ObjectiveDescriptor descriptor, const std::string& source) {
  if (!descriptor.make || descriptor.help.empty()) {
    throw InputError(source + ": guidance objective '" + descriptor.name +
                     "': its descriptor lacks a constructor or a sentence of help");
  }
  table().add(std::move(descriptor), source);
}

std::vector<std::string> objectiveNames() { return table().names(); }

const char* objectiveText(const std::string& name) { return table().at(name).help.c_str(); }

std::unique_ptr<Objective> makeObjective(const std::string& name) {
  const core::NamedCall call(kKind, name);
  auto objective = requireMade(name, table().at(name).make());
  if (!core::isPlugin(table().sourceOf(name))) return objective;
  return std::make_unique<ForeignObjective>(name, std::move(objective));
}

std::string objectiveSource(const std::string& name) { return table().sourceOf(name); }

}  // namespace cdiff::guidance
