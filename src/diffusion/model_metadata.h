// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// What the metadata of the weight files says about a model: sizes in both; normaliser, spread and
/// the encoder that it was trained with in the denoiser's.
#pragma once

#include <map>
#include <string>

#include "diffusion/model.h"

namespace cdiff::diffusion {

inline constexpr const char* kEncoderFormat = "e2e_cdiff.encoder.1";
inline constexpr const char* kDenoiserFormat = "e2e_cdiff.denoiser.1";

/// Of the denoiser's file: SHA-256 of the encoder's weights, as the encoder's file has it itself.
inline constexpr const char* kEncoderKey = "encoder";

using Metadata = std::map<std::string, std::string>;

/// Keys format and architecture of the encoder's file: the same weights make the same file.
Metadata describeEncoder(const Model& model);
/// Keys format, architecture, normalizer and spread of the denoiser's file.
Metadata describeDenoiser(const Model& model);

/// The architecture, after a check of the format. Throws InputError that begins with `source`.
Architecture readArchitecture(const Metadata& metadata, const std::string& format,
                              const std::string& source);

/// Sets normaliser and spread, which must fit model.architecture. Throws InputError that begins
/// with `source`.
void readScales(const Metadata& metadata, const std::string& source, Model& model);

/// Throws InputError when sizes, normaliser or spread of the model are not valid.
void validateDescription(const Model& model);

/// Whether a training fact of this name would hide one of the keys above or the checksum.
bool isReservedKey(const std::string& key);

}  // namespace cdiff::diffusion
