// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The fixed words of CBV identification (cbv/rejection_reason.h, cbv/held_cbv.h) as sentences for
/// people.
#pragma once

#include <string>

namespace cdiff::record {

/// Why a candidate was not taken; the word itself when it is not known.
std::string rejectionText(const std::string& reason);
/// Why a CBV left its slot; the word itself when it is not known.
std::string releaseText(const std::string& reason);

}  // namespace cdiff::record
