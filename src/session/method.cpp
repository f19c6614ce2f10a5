// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "session/method.h"

#include <algorithm>
#include <filesystem>

#include "core/file.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::session {
namespace {

namespace fs = std::filesystem;

fs::path methodFolder() { return core::shareFolder() / "config" / "methods"; }

}  // namespace

void MethodOptions::describe(core::OptionsVisitor& visitor) {
  visitor.text({"naturalistic_profile", "", "Guidance profile of CBVs in mode naturalistic."},
               naturalistic_profile, {});
  visitor.text({"safety_critical_profile", "", "Guidance profile of CBVs in mode safety_critical."},
               safety_critical_profile, {});
  visitor.text({"ego_profile", "", "Guidance profile of the ego."}, ego_profile, {});
  planner_options.describe(visitor);
}

const std::string& MethodOptions::profileOf(const std::string& mode) const {
  return mode == "safety_critical" ? safety_critical_profile : naturalistic_profile;
}

MethodOptions loadMethod(const std::string& name) {
  const std::vector<std::string> known = shippedMethods();
  if (std::find(known.begin(), known.end(), name) == known.end()) {
    throw core::InputError(
        "key 'method' is '" + name + "', an unknown method; the nearest one is '" +
        core::nearestName(name, known) + "' (all: " + core::joinText(known, ", ") + ")");
  }
  const fs::path file = methodFolder() / (name + ".yaml");
  MethodOptions options;
  core::loadOptions({file.string(), core::readFile(file, "method")}, options);
  return options;
}

std::vector<std::string> shippedMethods() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(methodFolder())) {
    if (entry.path().extension() == ".yaml") names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace cdiff::session
