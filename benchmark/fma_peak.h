// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Peak of one core in float32 fused multiply-adds [FLOP/s], measured in registers with the widest
/// vectors of this machine; the best of several short rounds.
#pragma once

namespace cdiff::benchmark {

double measureFmaPeak();

}  // namespace cdiff::benchmark
