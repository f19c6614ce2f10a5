// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <numeric>
#include <string>

#include "core/disk_memory.h"
#include "core/scratch_folder.h"

namespace cdiff::core {
namespace {

constexpr std::size_t kMegabyte = std::size_t{1} << 20;

/// Bytes of the process that lie in RAM and belong to files.
std::size_t fileBytesInRam() {
  std::ifstream status("/proc/self/status");
  std::string line;
  std::size_t bytes = 0;
  while (std::getline(status, line)) {
    for (const char* name : {"RssFile:", "RssShmem:"})  // the latter where the disk is RAM
      if (line.rfind(name, 0) == 0) bytes += 1024 * std::stoul(line.substr(line.find(':') + 1));
  }
  return bytes;
}

auto entriesOf(const std::filesystem::path& folder) {
  return std::distance(std::filesystem::directory_iterator(folder),
                       std::filesystem::directory_iterator());
}

std::pmr::vector<std::uint64_t> numbersTo(std::uint64_t end, std::pmr::memory_resource& memory) {
  std::pmr::vector<std::uint64_t> numbers(&memory);
  for (std::uint64_t i = 0; i < end; ++i) numbers.push_back(i);
  return numbers;
}

TEST(DiskMemory, LittleNeedsNoFile) {
  const ScratchFolder folder;
  DiskMemory memory(folder.path());
  const auto numbers = numbersTo(1000, memory);
  EXPECT_EQ(memory.onDisk(), 0U);
  EXPECT_EQ(numbers.back(), 999U);
}

TEST(DiskMemory, MuchLeavesTheRamAndComesBackWhole) {
  const ScratchFolder folder;
  const auto entries = entriesOf(folder.path());
  DiskMemory memory(folder.path(), kMegabyte);
  constexpr std::uint64_t kCount = 8 * kMegabyte;  // 64 MiB
  const auto numbers = numbersTo(kCount, memory);
  EXPECT_GE(memory.onDisk(), 64 * kMegabyte);
  EXPECT_EQ(entriesOf(folder.path()), entries);
  const std::size_t before = fileBytesInRam();
  memory.settle();
  EXPECT_GE(before, fileBytesInRam() + 60 * kMegabyte);
  EXPECT_EQ(std::accumulate(numbers.begin(), numbers.end(), std::uint64_t{0}),
            kCount * (kCount - 1) / 2);
}

TEST(DiskMemory, TakesRamWhereNoFileCanBe) {
  DiskMemory memory("/nowhere", 0);
  const auto numbers = numbersTo(2 * kMegabyte, memory);  // 16 MiB
  memory.settle();
  EXPECT_EQ(memory.onDisk(), 0U);
  EXPECT_EQ(numbers[kMegabyte], kMegabyte);
}

TEST(DiskMemory, KeepsTheAlignment) {
  const ScratchFolder folder;
  DiskMemory memory(folder.path(), 0);
  static_cast<void>(memory.allocate(1, 1));
  const auto place = reinterpret_cast<std::uintptr_t>(memory.allocate(64, 64));
  EXPECT_EQ(place % 64, 0U);
}

}  // namespace
}  // namespace cdiff::core
