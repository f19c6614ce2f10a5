// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "watch/page_access.h"

namespace cdiff::watch {
namespace {

class PageAccessTest : public testing::Test {
 protected:
  std::string path(const std::string& name = "") const {
    return access_.address().substr(access_.address().find('/', 8)) + name;
  }
  int get(const std::string& target, const std::string& host,
          const std::string& origin = "") const {
    return access_.refusal({"GET", target, host, origin, false});
  }
  const PageAccess access_{8080};
};

TEST_F(PageAccessTest, WhoKnowsTheAddressGetsThePage) {
  EXPECT_EQ(access_.address().rfind("http://127.0.0.1:8080/", 0), 0U);
  EXPECT_EQ(get(path(), "127.0.0.1:8080"), 0);
  EXPECT_EQ(get(path(), "localhost:8080"), 0);
  EXPECT_EQ(get(path("report.html"), "127.0.0.1:8080", "http://127.0.0.1:8080"), 0);
  EXPECT_EQ(PageAccess::name(path("report.html")), "report.html");
  EXPECT_EQ(
      access_.refusal({"GET", path("socket"), "127.0.0.1:8080", "http://127.0.0.1:8080", true}), 0);
}

TEST_F(PageAccessTest, EveryAddressHasATokenOfItsOwn) {
  EXPECT_NE(PageAccess(8080).address(), access_.address());
  EXPECT_EQ(path().size(), 34U) << "128 bits";
}

TEST_F(PageAccessTest, EverythingElseIsRefused) {
  const std::string host = "127.0.0.1:8080";
  std::string almost = path();
  almost[32] = almost[32] == '0' ? '1' : '0';
  EXPECT_EQ(get("/", host), 403);
  EXPECT_EQ(get("", host), 403);
  EXPECT_EQ(get(almost, host), 403);
  EXPECT_EQ(get(path().substr(0, 33), host), 403) << "without the last slash";
  EXPECT_EQ(get("//" + path(), host), 403);
  EXPECT_EQ(get(path("../"), host), 404);
  EXPECT_EQ(get(path("summary.json"), host), 404);
  EXPECT_EQ(get(path(), ""), 403);
  EXPECT_EQ(get(path(), "127.0.0.1"), 403);
  EXPECT_EQ(get(path(), "127.0.0.1:80"), 403);
  EXPECT_EQ(get(path(), "evil.example:8080"), 403) << "a name that was pointed here";
  EXPECT_EQ(get(path(), host, "http://evil.example"), 403);
  EXPECT_EQ(get(path(), host, "null"), 403);
  EXPECT_EQ(get(path(), host, "https://127.0.0.1:8080"), 403);
  EXPECT_EQ(get(path("socket"), host), 404) << "no socket is asked for";
  EXPECT_EQ(access_.refusal({"POST", path(), host, "", false}), 405);
}

TEST_F(PageAccessTest, ASocketNeedsAPageOfThisServer) {
  const auto socket = [&](const std::string& origin) {
    return access_.refusal({"GET", path("socket"), "127.0.0.1:8080", origin, true});
  };
  EXPECT_EQ(socket(""), 403);
  EXPECT_EQ(socket("http://127.0.0.1:8081"), 403);
  EXPECT_EQ(socket("http://localhost:8080"), 403) << "another name than that of the request";
  EXPECT_EQ(access_.refusal({"GET", path(), "127.0.0.1:8080", "http://127.0.0.1:8080", true}), 404);
}

}  // namespace
}  // namespace cdiff::watch
