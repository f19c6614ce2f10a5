// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "diffusion/normalizer.h"

#include <cmath>
#include <string>

#include "core/text.h"
#include "diffusion/rollout_json.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::diffusion {
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
