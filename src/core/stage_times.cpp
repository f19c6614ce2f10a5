// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "core/stage_times.h"

#include <cstdlib>
#include <stdexcept>

#include "core/file.h"
#include "core/text.h"

namespace cdiff::core {
namespace {

thread_local StageTimes* times_of_thread = nullptr;

/// The wanted file; empty: none.
std::string wantedFile() {
  const char* file = std::getenv(kStagesVariable);
  return file == nullptr ? "" : file;
}

}  // namespace

StageTimes::StageTimes() {
  if (times_of_thread != nullptr)
    throw std::logic_error("this thread's stages are being measured already");
  times_of_thread = this;
}

StageTimes::~StageTimes() { times_of_thread = nullptr; }

TimedStage::TimedStage(const char* name) : times_(times_of_thread) {
  if (times_ == nullptr) return;
  name_ = name;
  outer_ = times_->innermost_;
  times_->innermost_ = this;
  begin_ = Clock::now();
}

TimedStage::~TimedStage() {
  if (times_ == nullptr) return;
  const Clock::duration whole = Clock::now() - begin_;
  times_->seconds_[name_] += std::chrono::duration<double>(whole - inside_).count();
  times_->innermost_ = outer_;
  if (outer_ != nullptr) outer_->inside_ += whole;
}

std::unique_ptr<StageTimes> wantedStageTimes() {
  return wantedFile().empty() ? nullptr : std::make_unique<StageTimes>();
}

void writeStageTimes(const StageTimes* times) {
  if (times == nullptr) return;
  std::string lines;
  for (const auto& [stage, seconds] : times->seconds())
    lines += stage + " " + formatNumber(seconds) + "\n";
  writeFileAtomically(wantedFile(), lines);
}

}  // namespace cdiff::core
