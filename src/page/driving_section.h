// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include "core/markup.h"
#include "record/session_result.h"

namespace cdiff::page {

/// Distributions of speed and acceleration of CBVs against background vehicles.
core::Markup drivingSection(const record::SessionResult& result);

}  // namespace cdiff::page
