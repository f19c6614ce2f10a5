// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <filesystem>
#include <memory_resource>
#include <vector>

#include "core/file_descriptor.h"

namespace cdiff::core {

/// Memory for what a long session gathers: the first bytes lie in RAM, all others in a file without
/// a name. Nothing is given back before the object ends. Where the file cannot be made or grow, RAM
/// takes its place. For one thread, and not for a forked process.
class DiskMemory final : public std::pmr::memory_resource {
 public:
  static constexpr std::size_t kInRam = std::size_t{1} << 24;  ///< [bytes]

  /// The file lies in the file system of `folder`, and is made when more than `in_ram` bytes are
  /// asked for.
  explicit DiskMemory(std::filesystem::path folder, std::size_t in_ram = kInRam);
  ~DiskMemory() override;
  DiskMemory(const DiskMemory&) = delete;
  DiskMemory& operator=(const DiskMemory&) = delete;

  /// Takes the file's content out of the process's RAM. What is read or written next comes back.
  void settle();
  /// Size of the file [bytes].
  std::size_t onDisk() const { return static_cast<std::size_t>(file_size_); }

 private:
  struct Block {
    std::byte* begin = nullptr;
    std::size_t size = 0;
    bool on_disk = false;
  };
  void* do_allocate(std::size_t bytes, std::size_t alignment) override;
  void do_deallocate(void* /*place*/, std::size_t /*bytes*/, std::size_t /*alignment*/) override {}
  bool do_is_equal(const std::pmr::memory_resource& other) const noexcept override {
    return this == &other;
  }
  Block makeBlock(std::size_t size);
  std::byte* mapFile(std::size_t size);

  std::filesystem::path folder_;
  std::size_t in_ram_;
  std::size_t ram_size_ = 0;
  FileDescriptor file_;
  off_t file_size_ = 0;
  std::vector<Block> blocks_;
  std::size_t used_ = 0;  ///< of the last block [bytes]
};

}  // namespace cdiff::core
