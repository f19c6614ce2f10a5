// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include "diffusion/network/architecture.h"
#include "diffusion/normalizer.h"
#include "inference/safetensors.h"

namespace cdiff::diffusion {

/// The trained planner as it comes from disk: encoder.safetensors and denoiser.safetensors in one
/// folder, with the architecture in the metadata of each, normalizer and spread in the denoiser's.
struct Model {
  std::string name;    ///< for records: folder name
  std::string sha256;  ///< SHA-256 over both data sections
  Architecture architecture;
  Normalizer normalizer;
  traffic::Rollout spread;  ///< [T, 7] sd of the clean trajectory given its context, normalized
  std::map<std::string, inference::Tensor> encoder;
  std::map<std::string, inference::Tensor> denoiser;
};

/// Reads a folder, or the name of a shipped model (share folder, weights/NAME). Throws InputError:
/// see readSafetensors; also when the encoder is not the one that the denoiser was trained with
/// (architecture, and SHA-256 where the denoiser names it), or the metadata keys "format"
/// ("e2e_cdiff.encoder.1", "e2e_cdiff.denoiser.1"), "architecture" and, of the denoiser,
/// "normalizer" and "spread" are missing or malformed.
Model loadModel(const std::string& name_or_folder);

/// As loadModel; the kept one where this process keeps content (core/kept_content.h).
std::shared_ptr<const Model> sharedModel(const std::string& name_or_folder);

/// All that a network depends on which is made of the model.
std::string identityOf(const Model& model);

/// Identifies the files of a folder or shipped model for records: SHA-256 of the hashes of encoder
/// and denoiser file, one after the other. Throws InputError for an unknown model or missing file.
std::string modelFilesSha256(const std::string& name_or_folder);

/// Names of the two files.
inline constexpr const char* kEncoderFile = "encoder.safetensors";
inline constexpr const char* kDenoiserFile = "denoiser.safetensors";

/// The content of the two files, the denoiser's without the hash of the encoder's.
struct ModelFiles {
  inference::SafetensorsFile encoder;
  inference::SafetensorsFile denoiser;
};
/// Throws InputError naming the tensor or description that is missing or malformed.
ModelFiles modelFiles(const Model& model);

/// Writes both files into `folder`; `training_facts` go into the denoiser's.
void saveModel(const Model& model, const std::filesystem::path& folder, inference::TensorType type,
               const std::map<std::string, std::string>& training_facts);

// What the metadata of the weight files says about a model: sizes in both; normalizer, spread and
// the encoder that it was trained with in the denoiser's.

inline constexpr const char* kEncoderFormat = "e2e_cdiff.encoder.1";
inline constexpr const char* kDenoiserFormat = "e2e_cdiff.denoiser.1";

/// Of the denoiser's file: SHA-256 of the encoder's weights, as the encoder's file has it itself.
inline constexpr const char* kEncoderKey = "encoder";

using Metadata = std::map<std::string, std::string>;

/// Keys format and architecture of the encoder's file: the same weights make the same file.
Metadata describeEncoder(const Model& model);
/// Keys format, architecture, normalizer and spread of the denoiser's file.
Metadata describeDenoiser(const Model& model);

/// The architecture, after a check of the format. Throws InputError that starts with `source`.
Architecture readArchitecture(const Metadata& metadata, const std::string& format,
                              const std::string& source);

/// Sets normalizer and spread, which must fit model.architecture. Throws InputError that starts
/// with `source`.
void readScales(const Metadata& metadata, const std::string& source, Model& model);

/// Throws InputError when sizes, normalizer or spread of the model are not valid.
void validateDescription(const Model& model);

/// Whether a training fact of this name would hide one of the keys above or the checksum.
bool isReservedKey(const std::string& key);

}  // namespace cdiff::diffusion
