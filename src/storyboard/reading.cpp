// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "storyboard/reading.h"

#include <algorithm>
#include <filesystem>

#include "core/file.h"
#include "core/text.h"

namespace cdiff::storyboard {

namespace fs = std::filesystem;

Catalogs::Catalogs(const XoscElement& locations) {
  for (const XoscElement& location : locations.children()) {
    const XoscElement directory = location.child("Directory");
    const fs::path named = directory.text("path");
    const fs::path folder = fs::path(directory.source().file).parent_path() / named;
    if (core::isFile(folder)) {
      add(folder.string());
      continue;
    }
    if (!core::isFolder(folder))
      directory.fail("there is no folder '" + folder.string() + "'; expected catalogs there");
    std::vector<std::string> files;
    for (const fs::directory_entry& file : fs::directory_iterator(folder))
      if (file.path().extension() == ".xosc") files.push_back(file.path().string());
    std::sort(files.begin(), files.end());
    for (const std::string& file : files) add(file);
  }
}

void Catalogs::add(const std::string& file) {
  files_.push_back(file);
  const auto catalog = XoscElement::load(file).find("Catalog");
  if (!catalog) return;
  std::vector<XoscElement>& entries = entries_[catalog->text("name")];
  for (const XoscElement& entry : catalog->children()) entries.push_back(entry);
}

XoscElement Catalogs::entry(const XoscElement& reference) const {
  constexpr std::size_t kMost = 100000;
  if (++taken_ > kMost)
    reference.fail("entries of catalogs refer to each other more than " + std::to_string(kMost) +
                   " times");
  const std::string catalog = reference.text("catalogName");
  const std::string name = reference.text("entryName");
  const auto found = entries_.find(catalog);
  if (found == entries_.end()) {
    std::vector<std::string> known;
    for (const auto& entry : entries_) known.push_back(entry.first);
    reference.fail("there is no catalog '" + catalog + "'; expected one of {" +
                   core::joinText(known, ", ") + "}");
  }
  Parameters given;
  if (const auto assignments = reference.find("ParameterAssignments")) {
    for (const XoscElement& assignment : assignments->children("ParameterAssignment"))
      given[assignment.text("parameterRef")] = assignment.text("value");
  }
  for (const XoscElement& entry : found->second)
    if (entry.text("name", "") == name)
      return resolve(entry.asEntryFor(reference).declaring(given));
  reference.fail("the catalog '" + catalog + "' has no entry '" + name + "'");
}

XoscElement Catalogs::resolve(const XoscElement& element) const {
  return element.name() == "CatalogReference" ? entry(element) : element;
}

std::string readControllerName(const XoscElement& element, const Reading& reading) {
  const XoscElement controller = reading.catalogs.resolve(element);
  if (const auto properties = controller.find("Properties"))
    for (const XoscElement& property : properties->children("Property"))
      if (property.text("name") == "module") return property.text("value");
  return controller.text("name");
}

void Reading::refuse(const XoscElement& element, const std::string& what) {
  throw Unsupported(element.source().text() + ": <" + element.name() + ">: " + what +
                    " is not supported; --ignore-unsupported goes on without it");
}

void Reading::refuseAttributes(const XoscElement& element, const std::vector<const char*>& keys) {
  for (const char* key : keys)
    if (element.has(key)) refuse(element, std::string("the attribute '") + key + "'");
}

bool Reading::isAlongLanes(const XoscElement& element) {
  if (!element.has("coordinateSystem")) return false;
  const std::size_t frame =
      element.choice("coordinateSystem", {"entity", "lane", "road", "trajectory"});
  if (frame == 3) refuse(element, "a distance along a trajectory");
  return frame != 0;
}

void Reading::ignore(const Unsupported& error) {
  if (!ignore_unsupported) throw error;
  const std::string text = error.what();
  ignored.push_back(text.substr(0, text.find("; --ignore-unsupported")) + " and was ignored");
}

}  // namespace cdiff::storyboard
