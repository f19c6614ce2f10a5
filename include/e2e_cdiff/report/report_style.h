// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Style sheet and script of the HTML report.
#pragma once

namespace cdiff::report {

extern const char kReportStyleSheet[];
extern const char kReportScript[];

}  // namespace cdiff::report
