// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/scratch_folder.h"
#include "e2e_cdiff/core/exceptions.h"
#include "simulation/sumo_calls.h"

namespace cdiff::simulation {

/// SUMO ended by itself and says why in its error log, or crashed over what it was given: its own
/// words, without the files.
class SumoRefusal : public core::SimulatorError {
 public:
  using core::SimulatorError::SimulatorError;
};

/// A folder for SUMO's log: the given one (made when missing), or a temporary one that is removed
/// with the object.
class LogFolder {
 public:
  explicit LogFolder(const std::filesystem::path& wanted);
  std::filesystem::path errorLog() const { return path_ / "sumo_errors.log"; }
  std::filesystem::path output() const { return path_ / "sumo_output.log"; }

 private:
  std::unique_ptr<core::ScratchFolder> scratch_;  ///< where none is given
  std::filesystem::path path_;
};

/// What follows `mark` on the first line of a log that holds it, with the lines that continue it
/// (indented, or after a semicolon); empty when no line does.
std::string sentenceAfter(const std::string& mark, const std::filesystem::path& log);

/// The last lines of a log in one line; empty when there are none.
std::string lastLines(const std::filesystem::path& log);

/// A session with SUMO: a process (TraciLink), or SUMO in this process (InProcessLink). Every call
/// goes through `guarded`, which turns every way to fail into a SimulatorError that quotes SUMO; a
/// SumoRefusal where SUMO ended by itself, or crashed while it loaded its input.
class SumoLink {
 public:
  virtual ~SumoLink() = default;
  SumoLink(const SumoLink&) = delete;
  SumoLink& operator=(const SumoLink&) = delete;

  /// Runs calls to SUMO. `what` says in errors what was tried ("step").
  template <class Call>
  auto guarded(const std::string& what, Call&& call) {
    std::unique_ptr<Guard> guard;
    try {
      guard = guardCall();
      return std::forward<Call>(call)();
    } catch (...) {
      fail(what);
    }
  }
  /// Runs a call inside a guarded one; returns false when SUMO refuses it and throws on when SUMO
  /// is lost.
  bool attempt(const std::function<void()>& call);

  const SumoCalls& calls() const { return calls_; }
  const std::string& version() const { return version_; }
  /// Process id of SUMO.
  virtual int processId() const = 0;

 protected:
  /// What holds while a guarded call runs.
  struct Guard {
    virtual ~Guard() = default;
  };

  explicit SumoLink(const SumoCalls& calls) : calls_(calls) {}
  virtual std::unique_ptr<Guard> guardCall() = 0;
  /// Takes the loss of SUMO, which `reason` shows, and returns what an error says of it. Throws
  /// SumoRefusal where SUMO named a reason.
  virtual std::string lossText(const std::string& what, const std::string& reason) = 0;
  /// Throws what is being handled, as `guarded` says.
  [[noreturn]] void fail(const std::string& what);

  std::string version_;

 private:
  const SumoCalls& calls_;
};

}  // namespace cdiff::simulation
