// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "plugins/plugin_loader.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <class_loader/class_loader.hpp>
#include <cstdlib>
#include <memory>
#include <pugixml.hpp>
#include <system_error>

#include "core/file.h"
#include "core/file_descriptor.h"
#include "core/forked_work.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/plugins/plugin.h"
#include "guidance/objective_registry.h"
#include "planners/registry.h"
#include "session/scenario_options.h"

namespace cdiff::plugins {
namespace {

namespace fs = std::filesystem;
using core::InputError;

constexpr const char* kVariable = "E2E_CDIFF_PLUGINS";
constexpr int kDeepest = 4;  // folders below an entry of ROS_PACKAGE_PATH

std::vector<std::string> pathsIn(const char* variable) {
  const char* text = std::getenv(variable);
  return core::splitText(text == nullptr ? "" : text, ':');
}

/// Folders with a package.xml, as rospack finds them: not below another package, nor where a
/// CATKIN_IGNORE lies. Packages of an install space lie directly below `share`.
void findPackages(const fs::path& folder, int depth, std::vector<fs::path>& found) {
  std::error_code error;
  if (fs::exists(folder / "CATKIN_IGNORE", error)) return;
  if (fs::is_regular_file(folder / "package.xml", error)) {
    found.push_back(folder / "package.xml");
    return;
  }
  if (depth == 0) return;
  const int below = folder.filename() == "share" ? 0 : depth - 1;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    if (entry.is_directory(error) && entry.path().filename().string().front() != '.')
      findPackages(entry.path(), below, found);
  }
}

/// Where a library that a package exports may lie.
std::vector<fs::path> candidates(const fs::path& package_file, const std::string& library) {
  std::vector<fs::path> files = {package_file.parent_path() / library,
                                 package_file.parent_path() / "../../lib" / library};
  for (const std::string& prefix : pathsIn("CMAKE_PREFIX_PATH"))
    files.push_back(fs::path(prefix) / "lib" / library);
  return files;
}

PluginLibrary exported(const fs::path& package_file, const std::string& library) {
  std::vector<std::string> tried;
  for (const fs::path& file : candidates(package_file, library)) {
    if (core::isFile(file)) return {fs::canonical(file), package_file.string()};
    tried.push_back(file.lexically_normal().string());
  }
  throw InputError("'" + package_file.string() + "' exports the plug-in '" + library +
                   "', which is none of " + core::joinText(tried, ", ") +
                   "; build that package and source its setup.bash, or take the export out");
}

/// Exports of one package.xml.
void addExports(const fs::path& package_file, std::vector<PluginLibrary>& libraries) {
  pugi::xml_document document;
  if (!document.load_file(package_file.c_str())) return;  // rospack complains about these
  for (const pugi::xml_node& element :
       document.child("package").child("export").children("e2e_cdiff")) {
    const std::string library = element.attribute("plugin").value();
    if (!library.empty()) libraries.push_back(exported(package_file, library));
  }
}

}  // namespace

std::vector<PluginLibrary> findPlugins() {
  std::vector<PluginLibrary> named;
  for (const std::string& file : pathsIn(kVariable)) {
    if (!core::isFile(file))
      throw InputError(std::string(kVariable) + " names the plug-in '" + file +
                       "', which is no file; correct or unset it");
    named.push_back({fs::canonical(file), kVariable});
  }
  std::vector<fs::path> packages;
  for (const std::string& folder : pathsIn("ROS_PACKAGE_PATH"))
    findPackages(folder, kDeepest, packages);
  std::sort(packages.begin(), packages.end());
  for (const fs::path& package_file : packages) addExports(package_file, named);
  std::vector<PluginLibrary> libraries;
  for (PluginLibrary& library : named) {
    const bool known =
        std::any_of(libraries.begin(), libraries.end(),
                    [&](const PluginLibrary& other) { return other.file == library.file; });
    if (!known) libraries.push_back(std::move(library));
  }
  return libraries;
}

namespace {

/// The library stays loaded to the last: the tables hold its functions, and their destructors may
/// run after those of this file, so nothing here is destroyed.
class_loader::ClassLoader& openLibrary(const PluginLibrary& library, const std::string& what) {
  try {
    return *new class_loader::ClassLoader(library.file.string(), false);
  } catch (const class_loader::ClassLoaderException& error) {
    throw InputError(what + " cannot be loaded: " + error.what() +
                     "; build it again against this package");
  }
}

/// Calls a function of the plug-in's author.
template <class Call>
auto ask(const std::string& what, const std::string& where, const Call& call) {
  try {
    return call();
  } catch (const std::exception& error) {
    throw InputError(what + " throws in " + where + ": " + error.what() +
                     "; its author must mend it");
  } catch (...) {
    throw InputError(what + " throws in " + where + "; its author must mend it");
  }
}

void requireVersion(const Plugin& plugin, const std::string& what) {
  const int version = plugin.apiVersion();
  if (version == kApiVersion) return;
  throw InputError(what + " was built for version " + std::to_string(version) +
                   " of the API; this is version " + std::to_string(kApiVersion) +
                   ": build it again against this package");
}

/// The options of a planner are a group of the scenario file under its name, those of an objective
/// one of a guidance profile: `dump` holds the keys that there are at the top of either.
void requireFreeKey(const std::string& thing, const std::string& dump, const std::string& file,
                    const std::string& what) {
  if (("\n" + dump).find("\n" + thing + ":") == std::string::npos) return;
  throw InputError(what + " names something '" + thing + "', which is a key of " + file +
                   "; its author must choose another name");
}

void addAll(const Plugin& plugin, const std::string& what, LoadedPlugin& loaded) {
  for (planning::PlannerDescriptor& planner :
       ask(what, "planners()", [&] { return plugin.planners(); })) {
    if (planners::findPlanner(planner.name) == nullptr) {
      requireFreeKey(planner.name, core::dumpOptions(session::ScenarioOptions()), "scenario files",
                     what);
    }
    loaded.planners.push_back(planner.name);
    planners::registerPlanner(std::move(planner), what);
  }
  for (guidance::ObjectiveDescriptor& objective :
       ask(what, "objectives()", [&] { return plugin.objectives(); })) {
    const std::vector<std::string> known = guidance::objectiveNames();
    if (std::find(known.begin(), known.end(), objective.name) == known.end()) {
      requireFreeKey(objective.name, core::dumpOptions(guidance::GuidanceOptions()),
                     "guidance profiles", what);
    }
    loaded.objectives.push_back(objective.name);
    guidance::registerObjective(std::move(objective), what);
  }
  for (metrics::MetricDescriptor& metric :
       ask(what, "metrics()", [&] { return plugin.metrics(); })) {
    loaded.metrics.push_back(metric.name);
    metric.source = what;
    metrics::registerMetric(std::move(metric));
  }
}

/// Runs what every command runs of planners' options and of objectives, code of the author.
void askForOptions(const std::string& what) {
  ask(what, "the options of its planners or objectives", [] {
    const planning::PlannerOptionsTable options = planners::defaultOptions();
    core::dumpOptions(options);
    const guidance::GuidanceOptions guidance;
    core::dumpOptions(guidance);
  });
}

/// Defaults need not be valid: a planner may ask for a file of the user's.
void tryValidation() {
  planners::defaultOptions().validate();
  for (const guidance::WeightedObjective& entry : guidance::GuidanceOptions().objectives)
    entry.objective->validate();
}

LoadedPlugin loadHere(const PluginLibrary& library) {
  const std::string file = "plug-in '" + library.file.string() + "' (";
  const std::string what = file + "named by " + library.named_by + ")";
  class_loader::ClassLoader& loader = openLibrary(library, what);
  const std::vector<std::string> classes = loader.getAvailableClasses<Plugin>();
  if (classes.empty()) {
    throw InputError(what +
                     " exports no class of cdiff::plugins::Plugin; its author must add "
                     "CLASS_LOADER_REGISTER_CLASS(CLASS, cdiff::plugins::Plugin)");
  }
  LoadedPlugin loaded{library, {}, {}, {}};
  for (const std::string& name : classes) {
    const std::string of_class = file + "class " + name + ", named by " + library.named_by + ")";
    const auto plugin = ask(of_class, "its constructor", [&] {
      return std::shared_ptr<Plugin>(loader.createUnmanagedInstance<Plugin>(name));
    });
    requireVersion(*plugin, of_class);
    addAll(*plugin, of_class, loaded);
    askForOptions(of_class);
  }
  return loaded;
}

void silenceStreams() {
  const core::FileDescriptor nowhere(::open("/dev/null", O_WRONLY | O_CLOEXEC));
  ::dup2(nowhere.get(), STDOUT_FILENO);
  ::dup2(nowhere.get(), STDERR_FILENO);
}

/// Loads the library in a copy of this process first: code of it that runs meanwhile may end the
/// program, or go on for ever.
void requireLoadable(const PluginLibrary& library) {
  constexpr double kPatience = 30.0;  // [s]
  static const std::atomic<bool> never{false};
  const core::WorkEnd end = core::runForked(
      [&] {
        silenceStreams();
        const core::NamedCall call("plug-in", library.file.string());
        try {
          loadHere(library);
          tryValidation();
        } catch (...) {
          // It is said where the library is loaded for use.
        }
        return 0;
      },
      kPatience, never);
  if (end.exit_code) return;
  if (end.from_outside) {
    throw core::Error("plug-in '" + library.file.string() +
                      "' could not be loaded; the program that tried it ended: " + end.how);
  }
  throw InputError("plug-in '" + library.file.string() + "' (named by " + library.named_by +
                   ") ends the program that loads it: " + end.how +
                   "; build it again, or its author must mend it");
}

}  // namespace

LoadedPlugin loadPlugin(const PluginLibrary& library) {
  requireLoadable(library);
  return loadHere(library);
}

const std::vector<LoadedPlugin>& loadPlugins() {
  static const std::vector<LoadedPlugin> plugins = [] {
    std::vector<LoadedPlugin> loaded;
    for (const PluginLibrary& library : findPlugins()) loaded.push_back(loadPlugin(library));
    return loaded;
  }();
  return plugins;
}

}  // namespace cdiff::plugins
