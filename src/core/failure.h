// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// What a program says, and how it exits, when an exception reaches its main function.
#pragma once

#include <exception>
#include <string>

namespace cdiff::core {

struct Failure {
  int exit_code = 2;  ///< 2 error at run time, 3 bad input, 130 interrupted
  std::string text;   ///< for the user
};

/// The project's own errors keep their text. A path that the system refuses is bad input, named
/// with the system's reason; memory that ran out and errors of the standard library, which say
/// nothing to a user, are explained.
Failure failureOf(const std::exception& error);

}  // namespace cdiff::core
