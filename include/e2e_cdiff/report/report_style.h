// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Style sheet and script of the HTML report.
#pragma once

namespace cdiff::report {

const char* reportStyleSheet();
const char* reportScript();

}  // namespace cdiff::report
