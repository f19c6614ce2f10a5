// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>

#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::test {

/// The text of the InputError that an action throws, or "no error".
template <class Action>
std::string errorOf(const Action& action) {
  try {
    action();
  } catch (const core::InputError& error) {
    return error.what();
  }
  return "no error";
}

}  // namespace cdiff::test
