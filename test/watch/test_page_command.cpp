// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "e2e_cdiff/core/exceptions.h"
#include "session/scripted_session.h"
#include "watch/page_command.h"

namespace cdiff::watch {
namespace {

using Kind = PageCommand::Kind;

std::string refusalOf(const std::string& message) {
  try {
    commandFrom(message);
  } catch (const core::InputError& error) {
    return error.what();
  }
  return "";
}

TEST(PageCommand, IsReadFromJson) {
  EXPECT_EQ(commandFrom(R"({"do": "pause"})").kind, Kind::kPause);
  EXPECT_EQ(commandFrom(R"({"do": "resume"})").kind, Kind::kResume);
  EXPECT_EQ(commandFrom(R"({"do": "step", "ticks": 5})").ticks, 5U);
  EXPECT_EQ(commandFrom(R"({"do": "pace", "value": "0.5"})").pace, 0.5);
  const PageCommand steer =
      commandFrom(R"({"id": 7, "do": "steer", "what": "profile", "value": "natural<b>"})");
  EXPECT_EQ(steer.kind, Kind::kSteer);
  EXPECT_EQ(steer.what, "profile");
  EXPECT_EQ(steer.value, "natural<b>");
  EXPECT_EQ(commandNumber(R"({"id": 7})"), 7U);
}

TEST(PageCommand, WhatIsNoneIsRefused) {
  EXPECT_NE(refusalOf("").find("no JSON object"), std::string::npos);
  EXPECT_NE(refusalOf("{\"do\"").find("no JSON object"), std::string::npos);
  EXPECT_NE(refusalOf("[1]").find("no JSON object"), std::string::npos);
  EXPECT_NE(refusalOf(R"({"do": 5})").find("'do'"), std::string::npos);
  EXPECT_NE(refusalOf(R"({"do": "reset"})").find("expected pause, resume"), std::string::npos);
  EXPECT_NE(refusalOf(R"({"do": "step", "ticks": 0})").find("[1, 1000]"), std::string::npos);
  EXPECT_NE(refusalOf(R"({"do": "step", "ticks": -1})").find("[1, 1000]"), std::string::npos);
  EXPECT_NE(refusalOf(R"({"do": "step", "ticks": 1.5})").find("[1, 1000]"), std::string::npos);
  EXPECT_NE(refusalOf(R"({"do": "pace", "value": "fast"})").find("'fast'"), std::string::npos);
  EXPECT_NE(refusalOf(R"({"do": "steer", "what": "mode"})").find("'value'"), std::string::npos);
  EXPECT_EQ(commandNumber("[1]"), 0U);
  EXPECT_EQ(commandNumber(R"({"id": "x"})"), 0U);
}

TEST(ControlLink, DoesWhatTheControlDoes) {
  test::ScriptedSession scripted;
  const auto world = scripted.makeWorld();
  ControlLink link(world->control());
  std::string refused;
  const auto send = [&](const std::string& message) {
    link.send(commandFrom(message), [&](const std::string& text) { refused = text; });
    return refused;
  };
  EXPECT_EQ(link.state(), "playing");
  EXPECT_EQ(send(R"({"do": "pause"})"), "");
  EXPECT_EQ(link.state(), "paused");
  EXPECT_NE(send(R"({"do": "pause"})"), "") << "a paused one";
  EXPECT_EQ(send(R"({"do": "step", "ticks": 2})"), "");
  EXPECT_EQ(link.state(), "stepping");
  EXPECT_EQ(send(R"({"do": "resume"})"), "");
  EXPECT_EQ(send(R"({"do": "pace", "value": "4"})"), "");
  EXPECT_EQ(link.pace(), 4.0);
  EXPECT_NE(send(R"({"do": "pace", "value": "-1"})"), "");
  EXPECT_EQ(send(R"({"do": "steer", "what": "target_speed", "value": "5"})"), "");
  EXPECT_EQ(world->control().value("target_speed"), "5");
  EXPECT_NE(send(R"({"do": "steer", "what": "choose", "value": "nobody"})"), "");
  world->control().end();
  EXPECT_EQ(link.state(), "over");
}

}  // namespace
}  // namespace cdiff::watch
