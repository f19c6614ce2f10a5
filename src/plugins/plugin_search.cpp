// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <algorithm>
#include <cstdlib>
#include <pugixml.hpp>
#include <system_error>

#include "core/file.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "plugins/plugin_loader.h"

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

}  // namespace cdiff::plugins
