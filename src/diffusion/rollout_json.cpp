// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "diffusion/rollout_json.h"

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

}  // namespace cdiff::diffusion
