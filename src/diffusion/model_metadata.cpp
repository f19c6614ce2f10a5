// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "diffusion/model_metadata.h"

#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "diffusion/rollout_json.h"
#include "e2e_cdiff/core/exceptions.h"
#include "inference/strict_json.h"

namespace cdiff::diffusion {
namespace {

constexpr const char* kReservedKeys[] = {"format", "architecture", "normalizer",
                                         "spread", kEncoderKey,    "sha256"};

const std::string& textOf(const Metadata& metadata, const std::string& key,
                          const std::string& source) {
  const auto found = metadata.find(key);
  if (found == metadata.end()) {
    throw core::InputError(source + ": the metadata lacks the key '" + key + "'");
  }
  return found->second;
}

void requireSpread(const traffic::Rollout& spread, std::int64_t horizon) {
  if (spread.rows() != horizon) {
    throw core::InputError("spread: " + std::to_string(spread.rows()) +
                           " rows; T = " + std::to_string(horizon) + " was expected");
  }
  for (Eigen::Index i = 0; i < spread.size(); ++i) {
    const double value = spread.data()[i];
    if (std::isfinite(value) && value >= 0.0) continue;
    throw core::InputError("spread: row " + std::to_string(i / traffic::kRolloutColumns) +
                           ", column " + std::to_string(i % traffic::kRolloutColumns) + " is " +
                           core::formatNumber(value) + "; a value >= 0 was expected");
  }
}

}  // namespace

Metadata describeEncoder(const Model& model) {
  return {{"format", kEncoderFormat}, {"architecture", model.architecture.toJson()}};
}

Metadata describeDenoiser(const Model& model) {
  return {{"format", kDenoiserFormat},
          {"architecture", model.architecture.toJson()},
          {"normalizer", model.normalizer.toJson()},
          {"spread", rolloutText(model.spread)}};
}

Architecture readArchitecture(const Metadata& metadata, const std::string& format,
                              const std::string& source) {
  const std::string& actual = textOf(metadata, "format", source);
  if (actual != format) {
    throw core::InputError(source + ": the format is '" + inference::excerpt(actual) + "'; '" +
                           format + "' was expected");
  }
  return Architecture::fromJson(textOf(metadata, "architecture", source), source);
}

void readScales(const Metadata& metadata, const std::string& source, Model& model) {
  const std::int64_t rows = model.architecture.horizon;
  const std::string spread = source + ": metadata 'spread'";
  model.normalizer = Normalizer::fromJson(textOf(metadata, "normalizer", source), rows,
                                          source + ": metadata 'normalizer'");
  model.spread = rolloutOf(inference::parseStrictJson(textOf(metadata, "spread", source), spread),
                           rows, spread);
  try {
    validateDescription(model);
  } catch (const core::InputError& error) {
    throw core::InputError(source + ": " + error.what());
  }
}

void validateDescription(const Model& model) {
  model.architecture.validate();
  model.normalizer.validate(static_cast<int>(model.architecture.horizon));
  requireSpread(model.spread, model.architecture.horizon);
}

bool isReservedKey(const std::string& key) {
  return std::any_of(std::begin(kReservedKeys), std::end(kReservedKeys),
                     [&](const char* reserved) { return key == reserved; });
}

}  // namespace cdiff::diffusion
