// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The JSON header of a shard: {"fields" (SampleSchema), "samples", "facts"} in version 2. Version
/// 1 knew the samples of one planner only: {"schema" (DrivingSchema), "samples", "facts"}; its
/// samples are stored as version 2 stores the fields of a DrivingSample.
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "learning/field.h"

namespace cdiff::learning {

constexpr std::uint32_t kShardVersion = 2;

struct ShardHeader {
  SampleSchema schema;
  std::size_t samples = 0;
  std::map<std::string, std::string> facts;  ///< where the data come from
};

/// In the present version.
std::string headerText(const ShardHeader& header);
/// Throws InputError naming `source` for another version and for a header that is malformed.
ShardHeader readShardHeader(std::uint32_t version, const std::string& text,
                            const std::string& source);

}  // namespace cdiff::learning
