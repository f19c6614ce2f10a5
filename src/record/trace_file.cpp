// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "record/trace_file.h"

#include "core/csv.h"
#include "core/file.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "record/trace_writer.h"

namespace cdiff::record {
namespace {

using traffic::VehicleRole;

std::optional<VehicleRole> roleOf(const std::string& text) {
  for (const VehicleRole role : {VehicleRole::kEgo, VehicleRole::kCbv, VehicleRole::kBackground}) {
    if (text == traffic::toText(role)) return role;
  }
  return std::nullopt;
}

std::optional<TraceRow> rowOf(std::string_view line) {
  const std::vector<std::string> cells = core::csvCells(line);
  if (cells.size() != 10) return std::nullopt;
  const auto tick = core::parseNumber(cells[0]);
  const auto role = roleOf(cells[2]);
  const auto x = core::parseNumber(cells[3]);
  const auto y = core::parseNumber(cells[4]);
  const auto heading = core::parseNumber(cells[5]);
  const auto speed = core::parseNumber(cells[6]);
  if (!tick || *tick < 0.0 || !role || !x || !y || !heading || !speed) return std::nullopt;
  return TraceRow{static_cast<std::uint64_t>(*tick), cells[1], *role, {*x, *y}, *heading, *speed};
}

}  // namespace

std::vector<TraceRow> readTrace(const std::filesystem::path& file) {
  const std::string text = core::readFile(file, "trace");
  const std::string_view header = kTraceHeader;
  if (text.compare(0, header.size(), header) != 0) {
    throw core::InputError("'" + file.string() + "' is no trace; its first line must be " +
                           std::string(header.substr(0, header.size() - 1)));
  }
  std::vector<TraceRow> rows;
  std::size_t number = 2;
  for (std::size_t begin = header.size(); begin < text.size(); ++number) {
    const std::size_t end = text.find('\n', begin);
    const auto row = end == std::string::npos
                         ? std::nullopt
                         : rowOf(std::string_view(text).substr(begin, end - begin));
    if (!row) {
      throw core::InputError(file.string() + ":" + std::to_string(number) +
                             ": no row of a trace (tick, id, role, finite numbers, line end)");
    }
    rows.push_back(*row);
    begin = end + 1;
  }
  return rows;
}

}  // namespace cdiff::record
