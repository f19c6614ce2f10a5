// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "traffic/shown_fault.h"

#include <filesystem>
#include <new>
#include <stdexcept>

#include "core/markup.h"
#include "core/program.h"

namespace cdiff::traffic {

std::string shownFaultText(std::string_view text) {
  constexpr std::size_t kMostLetters = 1000;
  return core::cutText(text, kMostLetters);
}

bool isOfTheSystem(const std::exception& error) {
  return dynamic_cast<const std::bad_alloc*>(&error) != nullptr ||
         dynamic_cast<const std::length_error*>(&error) != nullptr ||
         dynamic_cast<const std::filesystem::filesystem_error*>(&error) != nullptr;
}

std::string thrownFaultText(const std::exception& error) {
  const std::string text = isOfTheSystem(error) ? core::failureOf(error).text : error.what();
  return text.empty() ? "an exception without a text" : shownFaultText(text);
}

std::string shownSource(std::string_view source) {
  constexpr std::size_t kMostLetters = 100;
  return core::cutText(source, kMostLetters);
}

Fault shownFault(const Fault& fault) {
  return {fault.tick, shownSource(fault.source), shownFaultText(fault.text)};
}

}  // namespace cdiff::traffic
