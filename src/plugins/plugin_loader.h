// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace cdiff::plugins {

// Loads plug-ins into the tables of planners, objectives and metrics. Libraries are found in
//  - E2E_CDIFF_PLUGINS: paths of libraries, separated by ':';
//  - package.xml of the packages along ROS_PACKAGE_PATH: <export><e2e_cdiff plugin="LIBRARY"/>,
//    where LIBRARY lies in lib/ of a prefix of CMAKE_PREFIX_PATH or of the package's own.

/// A library that is to be loaded, and who names it.
struct PluginLibrary {
  std::filesystem::path file;
  std::string named_by;  ///< "E2E_CDIFF_PLUGINS", or the package.xml
};

/// A library with the names that it added.
struct LoadedPlugin {
  PluginLibrary library;
  std::vector<std::string> planners;
  std::vector<std::string> objectives;
  std::vector<std::string> metrics;
};

/// Libraries that the environment names, each once. Throws InputError naming the variable or the
/// package.xml for one that does not exist.
std::vector<PluginLibrary> findPlugins();

/// Loads one library. Throws InputError naming the library and who must act when it cannot be
/// loaded, ends the program that loads it, exports no plug-in, was built for another version of the
/// API, throws, or takes a name twice or one of the scenario file's own. This process must have one
/// thread.
LoadedPlugin loadPlugin(const PluginLibrary& library);

/// Loads all that `findPlugins` finds, once per process; what was loaded.
const std::vector<LoadedPlugin>& loadPlugins();

}  // namespace cdiff::plugins
