// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/camera_ego/hungarian.h"

#include <limits>
#include <stdexcept>
#include <string>

namespace cdiff::planners {
namespace {

/// Rows and columns with their prices; index 0 is neither: a row or column in waiting.
class Assignment {
 public:
  Assignment(const std::vector<double>& cost, std::size_t rows, std::size_t columns)
      : cost_(cost),
        columns_(columns),
        row_price_(rows + 1, 0.0),
        column_price_(columns + 1, 0.0),
        row_of_(columns + 1, 0) {}

  /// Gives row `row` (from 1) a column; others may change theirs.
  void add(std::size_t row) {
    row_of_[0] = row;
    std::vector<std::size_t> before(columns_ + 1, 0);
    std::vector<double> least(columns_ + 1, std::numeric_limits<double>::infinity());
    std::vector<bool> visited(columns_ + 1, false);
    std::size_t column = 0;
    while (row_of_[column] != 0) column = step(column, before, least, visited);
    while (column != 0) {
      row_of_[column] = row_of_[before[column]];
      column = before[column];
    }
  }

  std::vector<int> columnsOfRows(std::size_t rows) const {
    std::vector<int> result(rows, -1);
    for (std::size_t column = 1; column <= columns_; ++column) {
      if (row_of_[column] != 0) result[row_of_[column] - 1] = static_cast<int>(column) - 1;
    }
    return result;
  }

 private:
  /// Visits a column; the next one to visit.
  std::size_t step(std::size_t column, std::vector<std::size_t>& before, std::vector<double>& least,
                   std::vector<bool>& visited) {
    visited[column] = true;
    const std::size_t row = row_of_[column];
    double gain = std::numeric_limits<double>::infinity();
    std::size_t next = 0;
    for (std::size_t j = 1; j <= columns_; ++j) {
      if (visited[j]) continue;
      const double rest = cost_[(row - 1) * columns_ + j - 1] - row_price_[row] - column_price_[j];
      if (rest < least[j]) {
        least[j] = rest;
        before[j] = column;
      }
      if (least[j] < gain || next == 0) {
        gain = least[j];
        next = j;
      }
    }
    for (std::size_t j = 0; j <= columns_; ++j) {
      if (visited[j]) {
        row_price_[row_of_[j]] += gain;
        column_price_[j] -= gain;
      } else {
        least[j] -= gain;
      }
    }
    return next;
  }

  const std::vector<double>& cost_;
  std::size_t columns_;
  std::vector<double> row_price_;
  std::vector<double> column_price_;
  std::vector<std::size_t> row_of_;  ///< by column; 0: none
};

}  // namespace

std::vector<int> hungarian(const std::vector<double>& cost, std::size_t rows, std::size_t columns) {
  if (rows > columns || cost.size() != rows * columns) {
    throw std::invalid_argument(
        "matching: " + std::to_string(rows) + " rows, " + std::to_string(columns) + " columns, " +
        std::to_string(cost.size()) + " costs; expected no more rows than " +
        "columns and a cost for each pair");
  }
  Assignment assignment(cost, rows, columns);
  for (std::size_t row = 1; row <= rows; ++row) assignment.add(row);
  return assignment.columnsOfRows(rows);
}

}  // namespace cdiff::planners
