// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <map>
#include <string>

namespace cdiff::core {

// How files that lock something name the process that holds it, in lines "key: value".

/// Lines host, process, program and since of this process. `program` is for people ("cdiff run").
std::string holderSignature(const std::string& program);

/// The lines of an open file by key; at most its first 1,024 bytes.
std::map<std::string, std::string> holderFacts(int descriptor);

/// "'cdiff run', process 12 on host h, since 2026-01-31 14:05:09"; long values are cut.
std::string holderText(const std::map<std::string, std::string>& facts);

}  // namespace cdiff::core
