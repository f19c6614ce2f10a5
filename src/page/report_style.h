// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Style sheet and script of the HTML report.
#pragma once

namespace cdiff::page {

extern const char kReportStyleSheet[];
extern const char kReportScript[];

}  // namespace cdiff::page
