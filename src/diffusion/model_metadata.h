// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// What the metadata of both weight files says about a model: sizes, normaliser, spread.
#pragma once

#include <map>
#include <string>

#include "e2e_cdiff/diffusion/model.h"

namespace cdiff::diffusion {

inline constexpr const char* kEncoderFormat = "e2e_cdiff.encoder.1";
inline constexpr const char* kDenoiserFormat = "e2e_cdiff.denoiser.1";

using Metadata = std::map<std::string, std::string>;

/// Keys format, architecture, normalizer and spread of a model's file.
Metadata describeModel(const Model& model, const std::string& format);

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
