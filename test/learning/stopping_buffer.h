// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// A log that stops the training that writes it.
#pragma once

#include <atomic>
#include <sstream>
#include <string>
#include <utility>

namespace cdiff::test {

/// Sets a flag when a line with `text` is logged.
class StoppingBuffer : public std::stringbuf {
 public:
  StoppingBuffer(std::atomic<bool>& stop, std::string text) : stop_(stop), text_(std::move(text)) {}

 protected:
  int sync() override {
    if (str().find(text_) != std::string::npos) stop_ = true;
    return 0;
  }

 private:
  std::atomic<bool>& stop_;
  std::string text_;
};

}  // namespace cdiff::test
