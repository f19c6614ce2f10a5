// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include "core/markup.h"

namespace cdiff::page {

// Style sheets and scripts of the pages: the files in page/assets, written into each page so that
// it needs nothing else.

extern const core::Asset kReportStyle;  ///< of all pages
extern const core::Asset kReportScript;
extern const core::Asset kPanelSheetStyle;
extern const core::Asset kSampleSheetStyle;

}  // namespace cdiff::page
