// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "session/session_control.h"

namespace cdiff::watch {

/// Who steers by a page, in the record of a session.
inline constexpr const char* kLivePage = "live page";

/// What a page asks of a session.
struct PageCommand {
  enum class Kind { kPause, kResume, kStep, kPace, kSteer };
  Kind kind = Kind::kPause;
  std::uint64_t ticks = 0;  ///< of kStep
  double pace = 0.0;        ///< of kPace: at most times real time; 0: as fast as possible
  std::string what;         ///< of kSteer: a subject of traffic::steered
  std::string value;        ///< ... and its value
};

/// Number that a page gave its command, 0 where it cannot be read.
std::uint64_t commandNumber(const std::string& message);
/// From the JSON text {"id": 1, "do": "steer", "what": "profile", "value": "safety_critical"}.
/// Throws InputError that says what was expected.
PageCommand commandFrom(const std::string& message);

/// The way from live pages into a session. Calls come from the server's thread.
class SessionLink {
 public:
  /// Takes why a command was refused; empty: it is done. May be called from any thread.
  using Answer = std::function<void(const std::string& refused)>;

  virtual ~SessionLink() = default;
  /// Never waits.
  virtual void send(const PageCommand& command, Answer answer) = 0;
  /// "playing", "paused", "stepping" or "over", as far as is known.
  virtual std::string state() const = 0;
  /// At most so many times real time, as far as is known; 0: as fast as possible.
  virtual double pace() const = 0;
};

/// The link to a session of this process.
class ControlLink : public SessionLink {
 public:
  /// `control` must outlive the object.
  explicit ControlLink(session::SessionControl& control) : control_(control) {}
  void send(const PageCommand& command, Answer answer) override;
  std::string state() const override;
  double pace() const override { return control_.pace(); }

 private:
  session::SessionControl& control_;
};

}  // namespace cdiff::watch
