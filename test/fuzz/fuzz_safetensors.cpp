// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// A safetensors file is read, or refused with an InputError: of whatever bytes it is made.
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "e2e_cdiff/core/exceptions.h"
#include "inference/safetensors_header.h"

using namespace cdiff;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  try {
    const auto header = inference::parseHeader(bytes, 64, "fuzzed");
    inference::requireExpected(header, {{"a", {4, 4}}}, "fuzzed");
  } catch (const core::InputError&) {
  }
  return 0;
}
