// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "learning/samples/scene_file.h"

#include <stdexcept>

#include "core/output_folder.h"
#include "e2e_cdiff/core/exceptions.h"
#include "learning/samples/dataset.h"
#include "learning/samples/scene_tables.h"

namespace cdiff::learning {
namespace {

constexpr ShardKind kSceneKind = {"CDIFFSCN", "scene"};
constexpr const char* kVersionFact = "scene_version";

void requireVersion(const ShardReader& file) {
  const auto found = file.facts().find(kVersionFact);
  const std::string version = found == file.facts().end() ? "none" : found->second;
  if (version == std::to_string(kSceneVersion)) return;
  throw core::InputError(file.name() + ": scene version " + version + ", this program reads " +
                         std::to_string(kSceneVersion) + "; collect it again (cdiff collect)");
}

Scene sceneIn(const ShardReader& file) {
  requireVersion(file);
  if (!(file.schema() == sceneSchema()) || file.size() != 1) {
    throw core::InputError(file.name() + ": its tables are not those of a scene of version " +
                           std::to_string(kSceneVersion) + "; collect it again (cdiff collect)");
  }
  const Sample tables = file.sample(0);
  try {
    return sceneOfTables(tables);
  } catch (const std::out_of_range&) {
    throw core::InputError(file.name() + ": its tables do not fit each other");
  }
}

}  // namespace

std::string sceneBytes(const Scene& scene) {
  ShardWriter writer(sceneSchema(), kSceneKind);
  writer.append(tablesOf(scene));
  return writer.take({{kVersionFact, std::to_string(kSceneVersion)}, {"session", scene.name}});
}

Scene sceneOf(std::string bytes, const std::string& source) {
  return sceneIn(ShardReader(std::move(bytes), source, kSceneKind));
}

void writeScene(const std::filesystem::path& path, const Scene& scene) {
  core::writeOwnFile(path, sceneBytes(scene));
}

Scene readScene(const std::filesystem::path& path) {
  return sceneIn(ShardReader(path, kSceneKind));
}

}  // namespace cdiff::learning
