// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "watch/page_command.h"

#include <nlohmann/json.hpp>

#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::watch {
namespace {

using core::InputError;
using CommandJson = nlohmann::json;
using Kind = PageCommand::Kind;

constexpr std::uint64_t kMostPageSteps = 1000;  // of one command

/// Discarded when it is no JSON.
CommandJson parsed(const std::string& message) {
  return CommandJson::parse(message, nullptr, false);
}

std::string textOf(const CommandJson& command, const char* key) {
  const auto found = command.find(key);
  if (found != command.end() && found->is_string()) return *found;
  throw InputError("key '" + std::string(key) + "' of the page's command is missing or no text");
}

std::uint64_t ticksOf(const CommandJson& command) {
  const auto found = command.find("ticks");
  if (found != command.end() && found->is_number_unsigned() && *found >= 1U &&
      *found <= kMostPageSteps)
    return *found;
  throw InputError("step: expected 'ticks', a whole number in [1, " +
                   std::to_string(kMostPageSteps) + "]");
}

double paceOf(const CommandJson& command) {
  const std::string text = textOf(command, "value");
  if (const auto pace = core::parseNumber(text)) return *pace;
  throw InputError("pace '" + core::shortened(text) + "'; expected a number");
}

}  // namespace

std::uint64_t commandNumber(const std::string& message) {
  const CommandJson command = parsed(message);
  if (!command.is_object()) return 0;
  const auto found = command.find("id");
  return found != command.end() && found->is_number_unsigned() ? found->get<std::uint64_t>() : 0;
}

PageCommand commandFrom(const std::string& message) {
  const CommandJson command = parsed(message);
  if (!command.is_object()) throw InputError("a page's command is no JSON object");
  const std::string name = textOf(command, "do");
  PageCommand result;
  if (name == "pause") return result;
  if (name == "resume") {
    result.kind = Kind::kResume;
  } else if (name == "step") {
    result.kind = Kind::kStep;
    result.ticks = ticksOf(command);
  } else if (name == "pace") {
    result.kind = Kind::kPace;
    result.pace = paceOf(command);
  } else if (name == "steer") {
    result.kind = Kind::kSteer;
    result.what = textOf(command, "what");
    result.value = textOf(command, "value");
  } else {
    throw InputError("'" + core::shortened(name) +
                     "' is no command; expected pause, resume, step, pace or steer");
  }
  return result;
}

void ControlLink::send(const PageCommand& command, Answer answer) {
  try {
    switch (command.kind) {
      case Kind::kPause:
        control_.pause();
        break;
      case Kind::kResume:
        control_.resume();
        break;
      case Kind::kStep:
        control_.step(command.ticks);
        break;
      case Kind::kPace:
        control_.setPace(command.pace);
        break;
      case Kind::kSteer:
        control_.ask({kLivePage, command.what, command.value});
        break;
    }
    answer("");
  } catch (const InputError& error) {
    answer(error.what());
  }
}

std::string ControlLink::state() const {
  using State = session::SessionControl::State;
  switch (control_.state()) {
    case State::kPlaying:
      return "playing";
    case State::kPaused:
      return "paused";
    case State::kStepping:
      return "stepping";
    case State::kOver:
      break;
  }
  return "over";
}

}  // namespace cdiff::watch
