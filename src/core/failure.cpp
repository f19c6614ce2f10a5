// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "core/failure.h"

#include <filesystem>
#include <new>

#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::core {
namespace {

constexpr int kRunTimeError = 2;
constexpr int kBadInput = 3;
constexpr int kInterrupted = 130;

template <class Type>
const Type* as(const std::exception& error) {
  return dynamic_cast<const Type*>(&error);
}

std::string pathText(const std::filesystem::filesystem_error& error) {
  const std::string first = error.path1().string();
  const std::string path = first.empty() ? "the working directory" : "'" + first + "'";
  return "cannot use " + path + ": " + error.code().message() +
         "; a path that exists and can be read was expected";
}

}  // namespace

Failure failureOf(const std::exception& error) {
  const std::string text = error.what();
  if (as<InputError>(error) != nullptr) return {kBadInput, text};
  if (as<Interrupted>(error) != nullptr) return {kInterrupted, text};
  if (as<Error>(error) != nullptr) return {kRunTimeError, text};
  if (const auto* path = as<std::filesystem::filesystem_error>(error))
    return {kBadInput, pathText(*path)};
  if (as<std::bad_alloc>(error) != nullptr || as<std::length_error>(error) != nullptr) {
    return {
        kRunTimeError,
        "out of memory: the input asks for more than this machine can give; check its sizes, or "
        "use a machine with more memory"};
  }
  if (as<std::logic_error>(error) != nullptr) {
    return {kRunTimeError, "internal error (" + text +
                               "); please report it together with the command and its input"};
  }
  return {kRunTimeError, text};
}

}  // namespace cdiff::core
