// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "learning/curve_log.h"

#include <cerrno>
#include <cstring>
#include <sstream>

#include "core/csv.h"
#include "core/file.h"
#include "core/output_folder.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::learning {
namespace {

constexpr const char* kHeader = "stage,step,seconds,figure,value\n";
constexpr std::size_t kColumns = 5;

/// Rows of other stages, and of `stage` up to `step`.
std::string rowsKept(const std::filesystem::path& path, const std::string& stage,
                     std::int64_t step) {
  if (!std::filesystem::exists(path)) return {};
  std::istringstream rows(core::readFile(path, "training curves"));
  std::string kept;
  std::string row;
  std::getline(rows, row);
  while (std::getline(rows, row)) {
    const std::vector<std::string> cells = core::csvCells(row);
    if (cells.size() != kColumns) continue;  // cut off by a kill
    if (cells[0] != stage || std::strtoll(cells[1].c_str(), nullptr, 10) <= step)
      kept += row + "\n";
  }
  return kept;
}

}  // namespace

CurveLog::CurveLog(const std::string& output, std::string stage, std::int64_t step)
    : path_(std::filesystem::path(output) / "curves.csv"), stage_(std::move(stage)) {
  core::writeOwnFile(path_, kHeader + rowsKept(path_, stage_, step));
  file_.open(path_, std::ios::app);
}

void CurveLog::add(std::int64_t step, double seconds, const Measures& measures) {
  for (const auto& [name, value] : measures) {
    file_ << core::csvRow({stage_, std::to_string(step), core::formatFixed(seconds, 1), name,
                           core::formatNumber(value)});
  }
  file_.flush();
  if (!file_)
    throw core::InputError("training curves '" + path_.string() + "': " + std::strerror(errno));
}

}  // namespace cdiff::learning
