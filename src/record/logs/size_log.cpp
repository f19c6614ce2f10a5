// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "record/logs/size_log.h"

#include <optional>
#include <utility>

#include "core/csv.h"
#include "core/file.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::record {
namespace {

constexpr const char* kSizeHeader = "id,length,width,height\n";

std::optional<std::pair<std::string, traffic::VehicleDimensions>> sizeOf(std::string_view row) {
  const std::vector<std::string> cells = core::csvCells(row);
  if (cells.size() != 4) return std::nullopt;
  const auto length = core::parseNumber(cells[1]);
  const auto width = core::parseNumber(cells[2]);
  const auto height = core::parseNumber(cells[3]);
  if (!length || !width || !height || *length <= 0.0 || *width <= 0.0) return std::nullopt;
  return std::make_pair(cells[0], traffic::VehicleDimensions{*length, *width, *height});
}

}  // namespace

void SizeLog::observe(const traffic::TrafficSnapshot& snapshot) {
  for (const traffic::Vehicle& vehicle : snapshot.vehicles) {
    if (sizes_.emplace(vehicle.id, vehicle.dimensions).second) ids_.push_back(vehicle.id);
  }
}

std::string SizeLog::csv() const {
  std::string text = kSizeHeader;
  for (const std::string& id : ids_) {
    const traffic::VehicleDimensions& size = sizes_.at(id);
    text += core::csvRow({id, core::formatNumber(size.length), core::formatNumber(size.width),
                          core::formatNumber(size.height)});
  }
  return text;
}

SizesById readSizes(const std::filesystem::path& file) {
  const std::string text = core::readFile(file, "sizes of vehicles");
  const std::string_view header = kSizeHeader;
  if (text.compare(0, header.size(), header) != 0) {
    throw core::InputError("'" + file.string() + "' holds no sizes; its first line must be " +
                           std::string(header.substr(0, header.size() - 1)));
  }
  SizesById sizes;
  for (const core::CsvRow& row : core::csvRows(text)) {
    if (row.line == 1) continue;  // the header
    auto size = row.ended ? sizeOf(row.text) : std::nullopt;
    if (!size) {
      throw core::InputError(file.string() + ":" + std::to_string(row.line) +
                             ": no size of a vehicle (id, positive length and width, height)");
    }
    sizes.insert(std::move(*size));
  }
  return sizes;
}

}  // namespace cdiff::record
