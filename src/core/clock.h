// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>

namespace cdiff::core {

// The local time of the wall clock as text, to the second.

/// For people: "2026-01-31 14:05:09".
std::string timeText();

/// For the name of a file or folder: "20260131_140509".
std::string timeForFileName();

}  // namespace cdiff::core
