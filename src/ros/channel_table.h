// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The table of channels as documentation shows it.
#pragma once

#include <string>

namespace cdiff::ros {

/// A Markdown table, one line a channel, with a line break at the end. Absolute topic names are
/// those that a session without a namespace has.
std::string channelTable();

}  // namespace cdiff::ros
