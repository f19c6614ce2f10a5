// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Style sheets of a batch's page: the files in evaluation/assets.
#pragma once

#include "core/markup.h"

namespace cdiff::evaluation {

extern const core::Asset kBatchPageStyle;

}  // namespace cdiff::evaluation
