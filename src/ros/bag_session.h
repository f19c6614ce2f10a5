// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// A recorded session, read from its bag.
#pragma once

#include <filesystem>

#include "collection/driven_session.h"

namespace cdiff::ros {

/// Throws InputError naming the file and what is wrong with it.
collection::DrivenSession readBagSession(const std::filesystem::path& bag);

}  // namespace cdiff::ros
