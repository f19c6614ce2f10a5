// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <functional>
#include <string>

#include "core/forked_work.h"

namespace cdiff::cli {

/// What ended `ended` ("the session") in a copy of this process that did not return: the planner,
/// metric, objective or SUMO that was called then, or the plug-ins that may have done so.
std::string endText(const core::WorkEnd& end, const std::string& ended);

/// Runs a command in a copy of this process, because plug-ins, which are loaded, may end or stop
/// it; in this one where a plug-in has started threads. Gives its exit code; 2, with a word that
/// names the plug-in, where it did not return.
int runBesidePlugins(const std::function<int()>& command);

}  // namespace cdiff::cli
