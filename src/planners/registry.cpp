// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/registry.h"

#include <algorithm>
#include <map>
#include <mutex>
#include <utility>

#include "core/forked_work.h"
#include "core/program.h"
#include "core/registry.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "planners/planner_by_slot.h"
#include "traffic/shown_fault.h"

namespace cdiff::planners {
namespace {

using core::InputError;
using planning::PlannerDescriptor;

constexpr const char* kKind = "planner";

/// The preset of a rig must hold the cameras that a planner needs.
std::string faultOfCameras(const PlannerDescriptor& descriptor) {
  const std::vector<std::string>& presets = rendering::rigPresets();
  if (std::find(presets.begin(), presets.end(), descriptor.rig) == presets.end()) {
    return "its rig '" + descriptor.rig + "' is no preset; there are " +
           core::joinText(presets, ", ");
  }
  const rendering::CameraRig rig = rendering::rigOf({}, {}, descriptor.rig);
  for (const std::string& camera : descriptor.cameras) {
    if (rig.find(camera) != nullptr) continue;
    return "it needs the camera '" + camera + "'; its rig '" + descriptor.rig + "' has " +
           core::joinText(rig.names(), ", ");
  }
  return "";
}

/// What is wrong with a descriptor; empty when nothing is.
std::string faultOf(const PlannerDescriptor& descriptor) {
  if (descriptor.name == planning::kExternalPlanner)
    return "its name must be snake_case and other than 'external', the user's own node";
  if (!descriptor.options || !descriptor.options()) return "its descriptor has no options";
  if (!descriptor.make) return "its descriptor has no constructor";
  if (!descriptor.drives_ego && !descriptor.drives_cbv) return "it drives neither the ego nor CBVs";
  if (!descriptor.network != !descriptor.weights_sha256)
    return "its descriptor must have both 'network' and 'weights_sha256', or neither";
  return faultOfCameras(descriptor);
}

using Registry = core::Registry<PlannerDescriptor>;

/// Never destroyed: it holds functions of plug-ins, whose libraries may be unloaded before.
Registry& table() {
  static Registry& planners = *new Registry(kKind, packagePlanners());
  return planners;
}

/// The descriptor of "NAME+NAME...", made once; nullptr where one is unknown.
const PlannerDescriptor* findBySlot(const std::string& joined) {
  static std::mutex mutex;
  static auto& known = *new std::map<std::string, PlannerDescriptor>;  // as table()
  const std::vector<std::string> names = planningMembers(joined);
  if (names.size() < 2 || core::joinText(names, "+") != joined) return nullptr;
  std::vector<const PlannerDescriptor*> members;
  for (const std::string& name : names) members.push_back(table().find(name));
  if (std::count(members.begin(), members.end(), nullptr) > 0) return nullptr;
  const std::lock_guard<std::mutex> lock(mutex);
  const auto found = known.find(joined);
  if (found != known.end()) return &found->second;
  return &known.emplace(joined, describeBySlot(members)).first->second;
}

bool isBySlot(const std::string& name) { return name.find('+') != std::string::npos; }

/// The parts with the cameras of the planner's vehicles, which must hold those that it needs.
planning::PlannerParts withRig(const PlannerDescriptor& descriptor, planning::PlannerParts parts) {
  parts.rig = rendering::rigOf(parts.rig_options, parts.camera, descriptor.rig);
  rendering::requireCameras(parts.rig, descriptor.cameras,
                            {"planner '" + descriptor.name + "'", parts.rig_key});
  return parts;
}

/// A planner of a plug-in, whose calls are named to whoever waits for this process.
class ForeignPlanner : public planning::Planner {
 public:
  ForeignPlanner(std::string name, std::unique_ptr<planning::Planner> planner)
      : name_(std::move(name)), planner_(std::move(planner)) {}
  ~ForeignPlanner() override {
    const core::NamedCall call(kKind, name_);
    planner_.reset();
  }
  std::vector<planning::PlannedAction> plan(
      const traffic::TrafficSnapshot& snapshot,
      const std::vector<planning::PlanningTask>& tasks) override {
    const core::NamedCall call(kKind, name_);
    return planner_->plan(snapshot, tasks);
  }
  void setGuidance(const guidance::GuidanceOptions& guidance) override {
    const core::NamedCall call(kKind, name_);
    planner_->setGuidance(guidance);
  }

 private:
  std::string name_;
  std::unique_ptr<planning::Planner> planner_;
};

/// Fails over what the constructor of a plug-in's planner threw.
[[noreturn]] void failConstructor(const std::string& what, const std::exception& error) {
  const std::string text = what + traffic::thrownFaultText(error);
  const bool known =
      dynamic_cast<const core::Error*>(&error) != nullptr || traffic::isOfTheSystem(error);
  if (known && core::failureOf(error).exit_code == core::ExitCode::kRunTimeError)
    throw core::Error(text);
  throw InputError(text + "; correct what it names, or its author must mend it");
}

/// Errors of the constructors of this package say what the user must change; those of plug-ins need
/// the name of their author, too.
std::unique_ptr<planning::Planner> construct(const PlannerDescriptor& descriptor,
                                             const planning::PlannerParts& parts) {
  const std::string source = table().sourceOf(descriptor.name);
  const std::string what =
      "planner '" + descriptor.name + "' of " + source + ": its constructor throws: ";
  const bool foreign = core::isPlugin(source);
  const core::NamedCall call(kKind, descriptor.name, core::NamedCall::Limit::kWhenStopped);
  try {
    auto planner = descriptor.make(parts);
    if (!planner || !foreign) return planner;
    return std::make_unique<ForeignPlanner>(descriptor.name, std::move(planner));
  } catch (const std::exception& error) {
    if (!foreign || core::failureOf(error).exit_code == core::ExitCode::kInterrupted) throw;
    failConstructor(what, error);
  } catch (...) {
    throw InputError(what + "something that is no std::exception; its author must mend it");
  }
}

}  // namespace

void registerPlanner(PlannerDescriptor descriptor, const std::string& source) {
  const std::string fault = faultOf(descriptor);
  if (!fault.empty()) throw InputError(source + ": planner '" + descriptor.name + "': " + fault);
  table().add(std::move(descriptor), source);
}

const PlannerDescriptor* findPlanner(const std::string& name) {
  return isBySlot(name) ? findBySlot(name) : table().find(name);
}

std::vector<const PlannerDescriptor*> registeredPlanners() {
  std::vector<const PlannerDescriptor*> planners;
  for (const std::string& name : plannerNames()) planners.push_back(findPlanner(name));
  return planners;
}

std::string sourceOf(const std::string& name) { return table().sourceOf(name); }

std::unique_ptr<planning::Planner> makePlanner(const std::string& name,
                                               const planning::PlannerParts& parts) {
  if (name == planning::kExternalPlanner) {
    throw InputError(
        "planner 'external' is a node of the user's own: it needs the node graph "
        "(session.launch), not a planner in this process");
  }
  const PlannerDescriptor* known = findPlanner(name);
  const PlannerDescriptor& descriptor = known != nullptr ? *known : table().at(name);
  auto planner = construct(descriptor, isBySlot(name) ? parts : withRig(descriptor, parts));
  if (planner) return planner;
  throw InputError("planner '" + name + "' of " + sourceOf(name) +
                   ": its constructor gives none; its author must mend it");
}

planning::PlannerOptionsTable defaultOptions() {
  std::vector<planning::PlannerOptionsTable::Entry> entries;
  for (const PlannerDescriptor* descriptor : registeredPlanners()) {
    entries.push_back({descriptor->name, "Planner " + descriptor->name + ": " + descriptor->help,
                       descriptor->options()});
  }
  return planning::PlannerOptionsTable(std::move(entries));
}

std::vector<std::string> plannerNames() {
  std::vector<std::string> names = table().names();
  std::sort(names.begin(), names.end());
  return names;
}

std::vector<std::string> guidedPlannerNames() {
  std::vector<std::string> names = plannerNames();
  names.erase(std::remove_if(names.begin(), names.end(),
                             [](const std::string& name) { return !canBeGuided(name); }),
              names.end());
  return names;
}

bool canBeGuided(const std::string& name) {
  const PlannerDescriptor* descriptor = findPlanner(name);
  return descriptor != nullptr && descriptor->guided;
}

bool seesImages(const std::string& name) {
  const PlannerDescriptor* descriptor = findPlanner(name);
  return descriptor != nullptr && descriptor->sees();
}

std::string rigOfPlanner(const std::string& name) {
  const PlannerDescriptor* descriptor = findPlanner(name);
  return descriptor == nullptr ? rendering::kFrontRig : descriptor->rig;
}

void requireRig(const std::string& key, const std::string& name, const RigChoice& rig) {
  const PlannerDescriptor* descriptor = findPlanner(name);
  if (descriptor == nullptr) return;
  rendering::requireCameras(rendering::rigOf(rig.options, rig.camera, descriptor->rig),
                            descriptor->cameras, {key + " '" + name + "'", rig.key});
}

std::string plannerTitled(const std::string& title) {
  for (const PlannerDescriptor* descriptor : registeredPlanners()) {
    if (descriptor->title == title) return descriptor->name;
  }
  return "";
}

}  // namespace cdiff::planners
