// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "core/file.h"
#include "core/spelling.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/core/options.h"

namespace cdiff::session {

/// Reads the options in `folder`/NAME.yaml, a folder of shipped presets (protocols, methods).
/// Throws InputError for an unknown name: the text `refusal` ("protocol preset 'x' is not known"),
/// then the nearest shipped name and a list of all.
template <class Options>
Options loadPreset(const std::filesystem::path& folder, const std::string& name,
                   const std::string& refusal) {
  const std::vector<std::string> known = core::shippedNames(folder);
  if (std::find(known.begin(), known.end(), name) == known.end()) {
    throw core::InputError(refusal + "; the nearest one is '" + core::nearestName(name, known) +
                           "' (all: " + core::joinText(known, ", ") + ")");
  }
  const std::filesystem::path file = folder / (name + ".yaml");
  Options options;
  core::loadOptions({file.string(), core::readFile(file, "preset", core::kLargestOptionsFile)},
                    options);
  return options;
}

}  // namespace cdiff::session
