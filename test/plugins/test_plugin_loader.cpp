// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

#include "e2e_cdiff/core/exceptions.h"
#include "planners/registry.h"
#include "plugins/plugin_loader.h"
#include "session/closed_loop.h"
#include "session/scenario_options.h"
#include "support/error_text.h"
#include "support/temporary_folder.h"

namespace cdiff::plugins {
namespace {

namespace fs = std::filesystem;

PluginLibrary libraryOf(const std::string& kind) {
  return {fs::path(PLUGINS) / ("plugin_" + kind + ".so"), "the test"};
}

using test::errorOf;

std::string refusalOf(const std::string& kind) {
  return errorOf([&] { loadPlugin(libraryOf(kind)); });
}

void expectIn(const std::string& part, const std::string& text) {
  EXPECT_NE(text.find(part), std::string::npos) << text;
}

TEST(PluginLoader, AddsPlannersThatScenariosCanName) {
  const LoadedPlugin loaded = loadPlugin(libraryOf("good"));
  EXPECT_EQ(loaded.planners, std::vector<std::string>{"thrower"});
  expectIn("plugin_good.so", planners::sourceOf("thrower"));
  session::ScenarioOptions options;
  core::overrideOption("thrower.value=0.5", "--set", options);
  EXPECT_THROW(core::overrideOption("thrower.value=3", "--set", options), core::InputError);
  expectIn("is already registered by plug-in", refusalOf("good"));
}

TEST(PluginLoader, WhatThrowsInPlanBrakesAndIsRecorded) {
  if (planners::findPlanner("thrower") == nullptr) loadPlugin(libraryOf("good"));
  const session::ScenarioOptions options = session::loadScenario("crossing_left_turn");
  const session::SessionSetup setup(options);
  const auto planner =
      planners::makePlanner("thrower", {setup.planningContext(), options.planner_options,
                                        options.vehicle, options.camera, options.guidance});
  traffic::Vehicle vehicle;
  vehicle.id = "ego";
  planning::PlanningTask task;
  task.vehicle = &vehicle;
  double latency = 0.0;
  std::string fault;
  const auto actions = session::planTimed(*planner, {}, {task}, latency, fault);
  ASSERT_EQ(actions.size(), 1U);
  EXPECT_EQ(actions[0].action.brake, 1.0);
  expectIn("nothing can be planned here", fault);
}

TEST(PluginLoader, NamesWhatIsWrongAndWhoMustAct) {
  expectIn("was built for version 4 of the API; this is version 5: build it again",
           refusalOf("older_version"));
  expectIn("was built for version 6 of the API; this is version 5: build it again",
           refusalOf("newer_version"));
  expectIn("throws in its constructor: no license found; its author must mend it",
           refusalOf("throwing_constructor"));
  expectIn("throws in planners(): no planner today", refusalOf("throwing_list"));
  expectIn("planner 'pdm_lite' is already registered by package e2e_cdiff",
           refusalOf("taken_name"));
  expectIn("'camera', which is a key of scenario files", refusalOf("scenario_key"));
  expectIn("'trust_region', which is a key of guidance profiles", refusalOf("profile_key"));
  expectIn("planner 'bare': its descriptor has no options", refusalOf("no_options"));
  expectIn("exports no class of cdiff::plugins::Plugin", refusalOf("empty"));
  const test::TemporaryFolder folder;
  std::ofstream(folder.path() / "text.so") << "no library";
  expectIn("cannot be loaded", errorOf([&] {
             loadPlugin({folder.path() / "text.so", "the test"});
           }));
}

TEST(PluginLoader, OneThatEndsTheProgramIsNamed) {
  expectIn("throws in its constructor; its author must mend it", refusalOf("throwing_number"));
  expectIn("plugin_aborting.so' (named by the test) ends the program that loads it: signal 6",
           refusalOf("aborting"));
  expectIn("ends the program that loads it: exit code 0", refusalOf("leaving"));
}

// The loader of the system reads such a library beyond its end (SIGBUS), or says that it cannot.
TEST(PluginLoader, ATruncatedLibraryIsRefused) {
  const test::TemporaryFolder folder;
  const fs::path library = folder.path() / "truncated.so";
  for (const std::uintmax_t parts : {2, 4, 8}) {
    fs::copy_file(libraryOf("good").file, library, fs::copy_options::overwrite_existing);
    fs::resize_file(library, fs::file_size(library) / parts);
    expectIn("truncated.so' (named by the test)", errorOf([&] {
               loadPlugin({library, "the test"});
             }));
  }
}

/// Sets an environment variable for as long as it lives.
class Variable {
 public:
  Variable(const char* name, const std::string& value) : name_(name) {
    const char* before = std::getenv(name);
    if (before != nullptr) before_ = before;
    ::setenv(name, value.c_str(), 1);
  }
  ~Variable() {
    if (before_.empty())
      ::unsetenv(name_);
    else
      ::setenv(name_, before_.c_str(), 1);
  }

 private:
  const char* name_;
  std::string before_;
};

void writePackage(const fs::path& folder, const std::string& library) {
  fs::create_directories(folder);
  std::ofstream(folder / "package.xml")
      << "<package><export><e2e_cdiff plugin=\"" << library << "\"/></export></package>";
}

TEST(PluginSearch, FindsLibrariesOfPackagesAndOfTheVariableOnce) {
  const test::TemporaryFolder folder;
  const Variable none("E2E_CDIFF_PLUGINS", libraryOf("good").file.string());
  const Variable prefix("CMAKE_PREFIX_PATH", (folder.path() / "prefix").string());
  const Variable packages("ROS_PACKAGE_PATH", (folder.path() / "src").string());
  fs::create_directories(folder.path() / "prefix/lib");
  fs::create_symlink(libraryOf("empty").file, folder.path() / "prefix/lib/mine.so");
  fs::create_symlink(libraryOf("good").file, folder.path() / "prefix/lib/again.so");
  writePackage(folder.path() / "src/deep/mine", "mine.so");
  writePackage(folder.path() / "src/again", "again.so");
  writePackage(folder.path() / "src/ignored", "lost.so");
  std::ofstream(folder.path() / "src/ignored/CATKIN_IGNORE") << "";
  const std::vector<PluginLibrary> found = findPlugins();
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].named_by, "E2E_CDIFF_PLUGINS");
  EXPECT_EQ(found[1].file, fs::canonical(libraryOf("empty").file));
}

TEST(PluginSearch, NamesALibraryThatIsNotThere) {
  const test::TemporaryFolder folder;
  {
    const Variable packages("ROS_PACKAGE_PATH", folder.path().string());
    writePackage(folder.path() / "mine", "lost.so");
    const std::string text = errorOf([] { findPlugins(); });
    expectIn((folder.path() / "mine/package.xml").string(), text);
    expectIn("lost.so", text);
  }
  const Variable named("E2E_CDIFF_PLUGINS", "/nowhere/lib.so");
  expectIn("E2E_CDIFF_PLUGINS names the plug-in '/nowhere/lib.so'", errorOf([] { findPlugins(); }));
}

}  // namespace
}  // namespace cdiff::plugins
