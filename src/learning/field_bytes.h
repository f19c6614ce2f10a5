// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Fields as the bytes of a shard (learning/shard.h) and back.
#pragma once

#include <string>

#include "learning/bytes.h"
#include "learning/field.h"

namespace cdiff::learning {

/// Appends a value that fits its schema.
void putField(std::string& bytes, const FieldSpec& spec, const FieldValue& value);
/// Reads forward over a field, and gives its value. Throws InputError naming `source` when a packed
/// field says more values than a sample can hold, or does not unpack to its size.
FieldValue takeField(ByteReader& reader, const FieldSpec& spec, const std::string& source);
/// Reads forward over a field.
void skipField(ByteReader& reader, const FieldSpec& spec);

}  // namespace cdiff::learning
