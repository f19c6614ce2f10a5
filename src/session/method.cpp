// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "session/method.h"

#include <filesystem>

#include "core/file.h"
#include "session/preset_file.h"

namespace cdiff::session {
namespace {

std::filesystem::path methodFolder() { return core::shareFolder() / "config" / "methods"; }

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
  return loadPreset<MethodOptions>(methodFolder(), name,
                                   "key 'method' is '" + name + "', an unknown method");
}

std::vector<std::string> shippedMethods() { return core::shippedNames(methodFolder()); }

}  // namespace cdiff::session
