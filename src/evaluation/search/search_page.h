// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "evaluation/search/search.h"

namespace cdiff::evaluation {

// What a search leaves besides the result folders of its sessions: found/, a scenario file of each
// case that was found; cases.csv, a row per case in the order of the search; index.html, the cases,
// the worst for the ego first. All follow from the sessions alone.

/// "3 of 48 cases have a contact of the moving ego; worst: case_0017 with score 1.432".
std::string searchText(const std::vector<SearchCase>& cases, bool asks_careful);

/// A row per case: id, batch from 1, score, found, contact, careful_survives, trace_sha256, then
/// the searched keys.
std::string casesCsv(const Search& search, std::size_t batch, const std::filesystem::path& results);

/// Text of index.html, self-contained; `title`: the scenario.
std::string searchPage(const Search& search, const std::string& title);

/// Writes them all, each file whole. Throws InputError naming a file that cannot be written.
void writeSearchFiles(const Search& search, const SearchRequest& request,
                      const std::filesystem::path& results);

}  // namespace cdiff::evaluation
