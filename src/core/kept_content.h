// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>

namespace cdiff::core {

// What a process keeps of the files that it has read, so that its next session need not make it
// again. Off unless keepContent() was called. To be used by one thread alone where it is on.

/// From now on keeps the `most` values that were asked for last; 0 drops all and keeps none.
void keepContent(std::size_t most);
/// Whether this process keeps any.
bool keepsContent();

/// The kept value of this key, or else what `make` gives; as keptContent below.
std::shared_ptr<void> keptValue(const std::string& key,
                                const std::function<std::shared_ptr<void>()>& make);

/// The value of a key: the kept one, or what `make` gives (a std::shared_ptr<Value>), which is kept
/// then. `kind` belongs to one type. `content` tells all that the value depends on, with the hash
/// of each file. Sessions share a kept value, so its answers must not depend on earlier ones.
/// Throws what `make` throws; nothing is kept then.
template <class Value, class Make>
std::shared_ptr<Value> keptContent(const std::string& kind, const std::string& content,
                                   const Make& make) {
  if (!keepsContent()) return make();
  return std::static_pointer_cast<Value>(
      keptValue(kind + '\0' + content, [&]() -> std::shared_ptr<void> { return make(); }));
}

}  // namespace cdiff::core
