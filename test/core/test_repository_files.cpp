// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <cstdlib>
#include <filesystem>

#include "core/file.h"

// Files of the repository that programs of others read: GitHub, citation tools, pre-commit.

namespace cdiff::core {
namespace {

namespace fs = std::filesystem;

fs::path repository() { return std::getenv("E2E_CDIFF_SHARE"); }

std::string valueOf(const YAML::Node& node, const std::string& key) {
  return node[key] ? node[key].as<std::string>() : "";
}

TEST(RepositoryFiles, CitationHasWhatItsFormatAsksFor) {
  const YAML::Node citation = YAML::LoadFile(repository() / "CITATION.cff");
  EXPECT_EQ(valueOf(citation, "cff-version"), "1.2.0");
  EXPECT_EQ(valueOf(citation, "title"), "e2e_cdiff");
  EXPECT_EQ(valueOf(citation, "license"), "BSD-3-Clause");
  for (const char* key : {"message", "abstract", "version", "date-released"})
    EXPECT_NE(valueOf(citation, key), "") << key;
  ASSERT_EQ(citation["authors"].size(), 1u);
  EXPECT_EQ(valueOf(citation["authors"][0], "name"), "The e2e_cdiff authors");
  ASSERT_EQ(citation["references"].size(), 1u);
  const YAML::Node paper = citation["references"][0];
  EXPECT_EQ(valueOf(paper, "type"), "article");
  EXPECT_NE(valueOf(paper, "title").find("Conditional Diffusion"), std::string::npos);
  EXPECT_EQ(paper["authors"].size(), 11u);
  for (const YAML::Node& author : paper["authors"])
    EXPECT_FALSE(valueOf(author, "given-names").empty() || valueOf(author, "family-names").empty());
}

TEST(RepositoryFiles, HooksDownloadNothing) {
  const YAML::Node hooks = YAML::LoadFile(repository() / ".pre-commit-config.yaml");
  ASSERT_EQ(hooks["repos"].size(), 1u);
  EXPECT_EQ(valueOf(hooks["repos"][0], "repo"), "local");
  EXPECT_GE(hooks["repos"][0]["hooks"].size(), 6u);
  for (const YAML::Node& hook : hooks["repos"][0]["hooks"]) {
    EXPECT_EQ(valueOf(hook, "language"), "system") << valueOf(hook, "id");
    EXPECT_NE(valueOf(hook, "name"), "") << valueOf(hook, "id");
    EXPECT_NE(valueOf(hook, "entry"), "") << valueOf(hook, "id");
  }
}

TEST(RepositoryFiles, IssueTemplatesNameThemselves) {
  int templates = 0;
  for (const fs::directory_entry& file :
       fs::directory_iterator(repository() / ".github" / "ISSUE_TEMPLATE")) {
    const std::string text = readFile(file.path(), "template");
    const std::size_t end = text.find("\n---\n");
    ASSERT_EQ(text.rfind("---\n", 0), 0u) << file.path();
    ASSERT_NE(end, std::string::npos) << file.path();
    const YAML::Node head = YAML::Load(text.substr(0, end));
    EXPECT_NE(valueOf(head, "name"), "") << file.path();
    EXPECT_NE(valueOf(head, "about"), "") << file.path();
    ++templates;
  }
  EXPECT_EQ(templates, 2);
}

}  // namespace
}  // namespace cdiff::core
