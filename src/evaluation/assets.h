// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include "core/markup.h"

namespace cdiff::evaluation {

// Style sheets of a batch's page: the files in evaluation/assets.

extern const core::Asset kBatchPageStyle;

}  // namespace cdiff::evaluation
