// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace cdiff::suite {

// Sealed suites: test routes that no setting, weight or rule was chosen by. FOLDER/seal.sha256
// holds a line "SHA-256  PATH" for every other file of the suite (sha256sum's format), and
// suite.yaml the key `sealed: true`; see docs/sealed_suites.md. Evaluation and data collection
// check the seal.

constexpr const char* kSealFile = "seal.sha256";

/// Whether the folder of a suite holds a seal.
bool hasSeal(const std::filesystem::path& suite_folder);

/// Throws InputError naming the file, the hash expected and the hash found when a file of a sealed
/// suite was changed, is missing or was added.
void requireIntactSeal(const std::filesystem::path& suite_folder);

/// Folder of the sealed suite that a scenario file, SUITE/scenarios/NAME.yaml, belongs to; nullopt
/// for every other file and for the name of a scenario.
std::optional<std::filesystem::path> sealedSuiteOf(const std::string& scenario);

/// Throws InputError when the scenario belongs to a sealed suite: sessions on its routes are those
/// of `cdiff evaluate --open-sealed`, which are on record. Whatever runs a single session calls it
/// first.
void requireOpen(const std::string& scenario);

/// Throws InputError when the scenario belongs to a sealed suite. Commands that make training data
/// call it first.
void requireNotSealed(const std::string& scenario);

}  // namespace cdiff::suite
