// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <filesystem>
#include <string>

#include "learning/samples/scene.h"

namespace cdiff::learning {

// A session as one file: `cdiff collect --scenes` writes it, trainings read it.

/// Version of what scene files hold; readers refuse others.
inline constexpr int kSceneVersion = 1;
inline constexpr const char* kSceneExtension = ".scene";

/// The bytes of a scene file: a shard (learning/samples/dataset.h) of the kind "CDIFFSCN" with one
/// sample, whose packed fields are the tables of the scene. Throws InputError for a state that is
/// not finite.
std::string sceneBytes(const Scene& scene);
/// Throws InputError naming `source` ("scene 'FILE'") and what is wrong: truncated, foreign,
/// another version, checksum, tables that do not fit each other.
Scene sceneOf(std::string bytes, const std::string& source);

/// Whole or absent. Throws InputError naming the path, also when the disk is full.
void writeScene(const std::filesystem::path& path, const Scene& scene);
/// Throws InputError as sceneOf, naming the path.
Scene readScene(const std::filesystem::path& path);

}  // namespace cdiff::learning
