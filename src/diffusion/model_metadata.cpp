// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "model_metadata.h"

#include <algorithm>
#include <cmath>

#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/core/text.h"
#include "strict_json.h"

namespace cdiff::diffusion {
namespace {

constexpr const char* kReservedKeys[] = {"format", "architecture", "normalizer",
                                         "spread", kEncoderKey,    "sha256"};

/// [[...], ...] with the shortest numbers that read back to the same double.
std::string matrixText(const traffic::Rollout& matrix) {
  std::string text = "[";
  for (Eigen::Index row = 0; row < matrix.rows(); ++row) {
    text += row == 0 ? "[" : ",[";
    for (Eigen::Index column = 0; column < matrix.cols(); ++column) {
      text += (column == 0 ? "" : ",") + core::formatNumber(matrix(row, column));
    }
    text += "]";
  }
  return text + "]";
}

const std::string& textOf(const Metadata& metadata, const std::string& key,
                          const std::string& source) {
  const auto found = metadata.find(key);
  if (found == metadata.end()) {
    throw core::InputError(source + ": the metadata lacks the key '" + key + "'");
  }
  return found->second;
}

/// A [rows, 7] matrix of numbers.
traffic::Rollout matrixOf(const Json& value, std::int64_t rows, const std::string& where) {
  if (!value.is_array() || value.size() != static_cast<std::size_t>(rows)) {
    throw core::InputError(where + " is " + kindOf(value) +
                           (value.is_array() ? " of " + std::to_string(value.size()) : "") +
                           "; T = " + std::to_string(rows) + " rows were expected");
  }
  traffic::Rollout matrix(rows, traffic::kRolloutColumns);
  for (std::int64_t row = 0; row < rows; ++row) {
    const Json& cells = value[static_cast<std::size_t>(row)];
    const std::string name = where + ", row " + std::to_string(row);
    if (!cells.is_array() || cells.size() != static_cast<std::size_t>(traffic::kRolloutColumns)) {
      throw core::InputError(name + ": " + std::to_string(traffic::kRolloutColumns) +
                             " numbers were expected");
    }
    for (int column = 0; column < traffic::kRolloutColumns; ++column) {
      const Json& cell = cells[static_cast<std::size_t>(column)];
      if (!cell.is_number()) {
        throw core::InputError(name + ", column " + std::to_string(column) + " is " + kindOf(cell) +
                               "; a number was expected");
      }
      matrix(row, column) = cell.get<double>();
    }
  }
  return matrix;
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

Normalizer normalizerOf(const Json& value, std::int64_t rows, const std::string& where) {
  if (!value.is_object() || value.size() != 2 || !value.contains("mean") ||
      !value.contains("scale")) {
    throw core::InputError(where + " is " + kindOf(value) +
                           "; an object of mean and scale was expected");
  }
  return {matrixOf(value["mean"], rows, where + "'s mean"),
          matrixOf(value["scale"], rows, where + "'s scale")};
}

}  // namespace

Metadata describeEncoder(const Model& model) {
  return {{"format", kEncoderFormat}, {"architecture", model.architecture.toJson()}};
}

Metadata describeDenoiser(const Model& model) {
  return {{"format", kDenoiserFormat},
          {"architecture", model.architecture.toJson()},
          {"normalizer", "{\"mean\":" + matrixText(model.normalizer.mean) +
                             ",\"scale\":" + matrixText(model.normalizer.scale) + "}"},
          {"spread", matrixText(model.spread)}};
}

Architecture readArchitecture(const Metadata& metadata, const std::string& format,
                              const std::string& source) {
  const std::string& actual = textOf(metadata, "format", source);
  if (actual != format) {
    throw core::InputError(source + ": the format is '" + excerpt(actual) + "'; '" + format +
                           "' was expected");
  }
  return Architecture::fromJson(textOf(metadata, "architecture", source), source);
}

void readScales(const Metadata& metadata, const std::string& source, Model& model) {
  const std::int64_t rows = model.architecture.horizon;
  const std::string normalizer = source + ": metadata 'normalizer'";
  const std::string spread = source + ": metadata 'spread'";
  model.normalizer = normalizerOf(
      parseStrictJson(textOf(metadata, "normalizer", source), normalizer), rows, normalizer);
  model.spread =
      matrixOf(parseStrictJson(textOf(metadata, "spread", source), spread), rows, spread);
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
