// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "diffusion/normalizer.h"

#include <cmath>
#include <string>

#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::diffusion {

std::string rolloutText(const traffic::Rollout& matrix) {
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

traffic::Rollout rolloutOf(const inference::Json& value, std::int64_t rows,
                           const std::string& where) {
  if (!value.is_array() || value.size() != static_cast<std::size_t>(rows)) {
    throw core::InputError(where + " is " + inference::kindOf(value) +
                           (value.is_array() ? " of " + std::to_string(value.size()) : "") +
                           "; T = " + std::to_string(rows) + " rows were expected");
  }
  traffic::Rollout matrix(rows, traffic::kRolloutColumns);
  for (std::int64_t row = 0; row < rows; ++row) {
    const inference::Json& cells = value[static_cast<std::size_t>(row)];
    const std::string name = where + ", row " + std::to_string(row);
    if (!cells.is_array() || cells.size() != static_cast<std::size_t>(traffic::kRolloutColumns)) {
      throw core::InputError(name + ": " + std::to_string(traffic::kRolloutColumns) +
                             " numbers were expected");
    }
    for (int column = 0; column < traffic::kRolloutColumns; ++column) {
      const inference::Json& cell = cells[static_cast<std::size_t>(column)];
      if (!cell.is_number()) {
        throw core::InputError(name + ", column " + std::to_string(column) + " is " +
                               inference::kindOf(cell) + "; a number was expected");
      }
      matrix(row, column) = cell.get<double>();
    }
  }
  return matrix;
}

namespace {

std::string cellText(const char* what, Eigen::Index row, Eigen::Index column, double value) {
  return std::string("normalizer: ") + what + " of row " + std::to_string(row) + ", column " +
         std::to_string(column) + " is " + core::formatNumber(value);
}

void requireRows(const char* what, const traffic::Rollout& values, int horizon) {
  if (values.rows() == horizon) return;
  throw core::InputError(std::string("normalizer: ") + what + " has " +
                         std::to_string(values.rows()) + " rows; T = " + std::to_string(horizon) +
                         " was expected");
}

}  // namespace

Trajectory Normalizer::normalize(const traffic::Rollout& metric) const {
  return (metric - mean).cwiseQuotient(scale).cast<float>();
}

traffic::Rollout Normalizer::denormalize(const Trajectory& trajectory) const {
  return trajectory.cast<double>().cwiseProduct(scale) + mean;
}

Trajectory Normalizer::toNormalizedGradient(const traffic::Rollout& gradient) const {
  return gradient.cwiseProduct(scale).cast<float>();
}

void Normalizer::validate(int horizon) const {
  requireRows("mean", mean, horizon);
  requireRows("scale", scale, horizon);
  for (Eigen::Index row = 0; row < mean.rows(); ++row) {
    for (Eigen::Index column = 0; column < traffic::kRolloutColumns; ++column) {
      const double middle = mean(row, column);
      const double width = scale(row, column);
      if (!std::isfinite(middle)) {
        throw core::InputError(cellText("mean", row, column, middle) +
                               "; a finite one was expected");
      }
      if (!std::isfinite(width) || !(width > 0.0)) {
        throw core::InputError(cellText("scale", row, column, width) +
                               "; a positive one was expected");
      }
    }
  }
}

std::string Normalizer::toJson() const {
  return "{\"mean\":" + rolloutText(mean) + ",\"scale\":" + rolloutText(scale) + "}";
}

Normalizer Normalizer::fromJson(const std::string& text, std::int64_t horizon,
                                const std::string& where) {
  const inference::Json value = inference::parseStrictJson(text, where);
  if (!value.is_object() || value.size() != 2 || !value.contains("mean") ||
      !value.contains("scale")) {
    throw core::InputError(where + " is " + inference::kindOf(value) +
                           "; an object of mean and scale was expected");
  }
  return {rolloutOf(value["mean"], horizon, where + "'s mean"),
          rolloutOf(value["scale"], horizon, where + "'s scale")};
}

}  // namespace cdiff::diffusion
