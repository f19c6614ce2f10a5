// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>

namespace cdiff::learning {

// What is recorded of a training: measures by name.

/// Names and values; the unit is in the name.
using Measures = std::map<std::string, double>;

/// The course of training as `curves.csv` in the output folder: stage, step, seconds of training,
/// measure, value; `cdiff report --training` draws it.
class CurveLog {
 public:
  /// Keeps the rows of other stages and those of this stage up to `step`, so that a resumed stage
  /// goes on where its checkpoint stands. Throws InputError when the file cannot be written.
  CurveLog(const std::string& output, std::string stage, std::int64_t step);

  /// One row for each measure, on disk at once. Throws InputError, as when the disk is full.
  void add(std::int64_t step, double seconds, const Measures& measures);

 private:
  std::filesystem::path path_;
  std::string stage_;
  std::ofstream file_;
};

}  // namespace cdiff::learning
