// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "core/kept_content.h"

#include <algorithm>
#include <deque>
#include <utility>

namespace cdiff::core {
namespace {

using Entry = std::pair<std::string, std::shared_ptr<void>>;

/// The value that was asked for last comes first.
struct Store {
  std::size_t most = 0;
  std::deque<Entry> entries;
};

Store& store() {
  static Store kept;
  return kept;
}

}  // namespace

void keepContent(std::size_t most) {
  store().most = most;
  if (store().entries.size() > most) store().entries.resize(most);
}

bool keepsContent() { return store().most > 0; }

std::shared_ptr<void> keptValue(const std::string& key,
                                const std::function<std::shared_ptr<void>()>& make) {
  std::deque<Entry>& entries = store().entries;
  const auto same = [&](const Entry& entry) { return entry.first == key; };
  const auto found = std::find_if(entries.begin(), entries.end(), same);
  Entry entry = found != entries.end() ? *found : Entry(key, make());
  // `make` may have kept values of its own.
  entries.erase(std::remove_if(entries.begin(), entries.end(), same), entries.end());
  entries.push_front(entry);
  if (entries.size() > store().most) entries.resize(store().most);
  return entry.second;
}

}  // namespace cdiff::core
