// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <stdexcept>
#include <string>

namespace cdiff::core {

// The error types of the project: each says who must act and carries the offending value in its
// text.

/// Root of every error that the project throws on purpose.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The user's input is wrong (file, line, key, id, range): the user must act. `cdiff` exits with 3.
class InputError : public Error {
 public:
  using Error::Error;
};

/// The traffic simulator or another process failed while running. `cdiff` exits with 2.
class SimulatorError : public Error {
 public:
  using Error::Error;
};

/// The session was interrupted by the user (SIGINT, SIGTERM). `cdiff` exits with 130.
class Interrupted : public Error {
 public:
  using Error::Error;
};

}  // namespace cdiff::core
