// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/weight_files.h"

#include <algorithm>

#include "core/file.h"
#include "core/kept_hash.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "inference/instruction_set.h"

namespace cdiff::planners {
namespace {

std::string trainingCommand(const WeightKind& kind) {
  return std::string("cdiff train --task ") + kind.planner + " " + kind.learns_from;
}

void requireFormat(const WeightKind& kind, const WeightMetadata& metadata,
                   const std::string& source) {
  const auto format = metadata.find("format");
  if (format != metadata.end() && format->second == kind.format) return;
  throw core::InputError(source + ": its format is " +
                         (format == metadata.end() ? "not named" : "'" + format->second + "'") +
                         ", not '" + kind.format +
                         "': these are not weights of this version's planner '" + kind.planner +
                         "'; train them with " + trainingCommand(kind));
}

}  // namespace

void WeightOptions::describe(core::OptionsVisitor& visitor) {
  visitor.text(
      {"weights", "", "Folder of its weights; a plain name is one in weights/ of the package."},
      weights, {});
}

std::filesystem::path WeightOptions::folder() const {
  const std::filesystem::path given(weights);
  return given == given.filename() ? core::shareFolder() / "weights" / given : given;
}

namespace {

/// Says which other weights a folder holds; empty where it holds none.
std::string otherWeights(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    if (entry.path().extension() == ".safetensors") names.push_back(entry.path().filename());
  }
  std::sort(names.begin(), names.end());
  return names.empty() ? "" : ", only weights of others: '" + core::joinText(names, "', '") + "'";
}

}  // namespace

std::filesystem::path weightFile(const WeightKind& kind, const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / kind.file;
  if (core::isFile(file)) return file;
  throw core::InputError("planner '" + std::string(kind.planner) +
                         "' has no weights: there is no file '" + file.string() + "'" +
                         otherWeights(folder) + "; train them with " + trainingCommand(kind) +
                         " --output " + folder.string() + ", or name a folder that holds them (" +
                         kind.planner + ".weights)");
}

std::string weightSha256(const WeightKind& kind, const std::filesystem::path& folder) {
  return core::keptSha256(weightFile(kind, folder), "weight file");
}

WeightTensors readWeights(const WeightKind& kind, const std::filesystem::path& folder,
                          const std::function<std::vector<inference::TensorShape>(
                              const WeightMetadata&, const std::string&)>& expected) {
  const std::filesystem::path file = weightFile(kind, folder);
  const std::string source = "weight file '" + file.string() + "'";
  return inference::readSafetensors(file,
                                    [&](const WeightMetadata& metadata) {
                                      requireFormat(kind, metadata, source);
                                      return expected(metadata, source);
                                    })
      .tensors;
}

core::YamlSource architectureText(const WeightMetadata& metadata, const std::string& source) {
  const auto sizes = metadata.find("architecture");
  if (sizes == metadata.end())
    throw core::InputError(source + ": its metadata lacks the key 'architecture'");
  return {source + ", architecture", sizes->second};
}

planning::NetworkFacts networkFactsOf(const WeightKind& kind, const NetworkText& text,
                                      const std::string& weights) {
  planning::NetworkFacts facts{weights, text.conditioning, text.sampling, {}};
  if (text.has_kernels) {
    facts.instruction_sets = {{std::string(kind.planner) + "_instruction_set",
                               inference::toText(inference::bestInstructionSet())}};
  }
  return facts;
}

}  // namespace cdiff::planners
