// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>

namespace cdiff::core {

/// Name of this machine, or of the container on it.
std::string hostName();

/// Names the kernel that runs this process, from its start on: processes with the same one see each
/// other's file locks at once. Empty where the system does not say.
std::string bootId();

}  // namespace cdiff::core
