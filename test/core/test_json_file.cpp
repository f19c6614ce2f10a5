// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/file.h"
#include "core/json_file.h"
#include "support/error_text.h"
#include "support/temporary_folder.h"

namespace cdiff::core {
namespace {

using test::errorOf;

std::string nested(std::size_t depth) { return std::string(depth, '[') + std::string(depth, ']'); }

std::string refusalOf(const std::string& text) {
  return errorOf([&] { requireShallowJson(text, "file 'f'"); });
}

TEST(JsonFile, DeepNestingIsRefusedWithItsSource) {
  EXPECT_EQ(refusalOf(nested(100)), "no error");
  EXPECT_EQ(refusalOf(nested(101)).rfind("file 'f': ", 0), 0U);
  std::string objects;
  for (int i = 0; i < 300000; ++i) objects += "{\"a\":";
  EXPECT_NE(refusalOf(objects), "no error");
}

TEST(JsonFile, BracketsInStringsAndBesideEachOtherDoNotNest) {
  EXPECT_EQ(refusalOf("{\"a\": \"" + std::string(500, '[') + "\"}"), "no error");
  EXPECT_EQ(refusalOf(R"({"a": "\"[[", "b": "\\"})"), "no error");
  std::string many;
  for (int i = 0; i < 500; ++i) many += "[{}],";
  EXPECT_EQ(refusalOf("[" + many + "0]"), "no error");
  EXPECT_NE(refusalOf(R"({"a": "\\", "b": )" + nested(100) + "}"), "no error");
}

TEST(JsonFile, AFileIsReadOrNamed) {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "summary.json";
  writeFileAtomically(file, R"({"a": [1, 2]})");
  EXPECT_EQ(readJson(file, "summary").at("a").size(), 2U);
  writeFileAtomically(file, nested(300000));
  const std::string error = errorOf([&] { readJson(file, "summary"); });
  EXPECT_EQ(error.rfind("summary '" + file.string() + "': ", 0), 0U) << error;
  writeFileAtomically(file, "{\"a\"");
  EXPECT_THROW(readJson(file, "summary"), nlohmann::json::exception);
}

/// What jsonFault() makes of the exception that an action throws.
template <class Action>
std::string faultOf(const Action& action) {
  try {
    action();
  } catch (const nlohmann::json::exception& error) {
    return jsonFault(error);
  }
  return "no error";
}

TEST(JsonFile, TheLibrarysNamesAreNotInItsFaults) {
  const auto value = nlohmann::json::parse(R"({"a": 1})");
  for (const std::string& fault :
       {faultOf([&] { value.at("b"); }), faultOf([&] { value.at("a").get<std::string>(); }),
        faultOf([] { return nlohmann::json::parse("{"); })}) {
    EXPECT_NE(fault, "no error");
    EXPECT_EQ(fault.find("json.exception"), std::string::npos) << fault;
    EXPECT_FALSE(fault.empty());
  }
  const std::string quoted =
      faultOf([] { return nlohmann::json::parse("{" + std::string(1000000, '7')); });
  EXPECT_LT(quoted.size(), 1000U);
}

}  // namespace
}  // namespace cdiff::core
