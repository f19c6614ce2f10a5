// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "core/disk_memory.h"

#include <fcntl.h>
#include <sys/mman.h>

#include <algorithm>
#include <cstdlib>
#include <new>
#include <string>
#include <utility>

namespace cdiff::core {
namespace {

constexpr std::size_t kBlock = std::size_t{1} << 22;  // [bytes]
constexpr std::size_t kPage = std::size_t{1} << 16;   // [bytes] no machine has larger ones

std::size_t roundedUp(std::size_t bytes, std::size_t unit) {
  return (bytes + unit - 1) / unit * unit;
}

/// A file that goes with its descriptor.
FileDescriptor namelessFile(const std::filesystem::path& folder) {
  FileDescriptor file(::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, S_IRUSR | S_IWUSR));
  if (file) return file;
  std::string name = (folder / ".session_XXXXXX").string();  // where O_TMPFILE is unknown
  file = FileDescriptor(::mkostemp(name.data(), O_CLOEXEC));
  if (file) ::unlink(name.c_str());
  return file;
}

}  // namespace

DiskMemory::DiskMemory(std::filesystem::path folder, std::size_t in_ram)
    : folder_(std::move(folder)), in_ram_(in_ram) {}

DiskMemory::~DiskMemory() {
  for (const Block& block : blocks_) ::munmap(block.begin, block.size);
}

void DiskMemory::settle() {
  for (const Block& block : blocks_) {
    if (block.on_disk) ::madvise(block.begin, block.size, MADV_DONTNEED);
  }
}

void* DiskMemory::do_allocate(std::size_t bytes, std::size_t alignment) {
  std::size_t begin = roundedUp(used_, alignment);
  if (blocks_.empty() || begin + bytes > blocks_.back().size) {
    blocks_.push_back(makeBlock(std::max(kBlock, roundedUp(bytes, kPage))));
    begin = 0;
  }
  used_ = begin + bytes;
  return blocks_.back().begin + begin;
}

DiskMemory::Block DiskMemory::makeBlock(std::size_t size) {
  if (ram_size_ + size > in_ram_) {
    if (std::byte* place = mapFile(size)) return {place, size, true};
  }
  void* place = ::mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (place == MAP_FAILED) throw std::bad_alloc();
  ram_size_ += size;
  return {static_cast<std::byte*>(place), size, false};
}

/// Maps the next part of the file, whose room is taken on the disk; nullptr where there is none.
std::byte* DiskMemory::mapFile(std::size_t size) {
  if (!file_) file_ = namelessFile(folder_);
  if (!file_ || ::posix_fallocate(file_.get(), file_size_, static_cast<off_t>(size)) != 0)
    return nullptr;
  void* place = ::mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED, file_.get(), file_size_);
  if (place == MAP_FAILED) return nullptr;
  file_size_ += static_cast<off_t>(size);
  return static_cast<std::byte*>(place);
}

}  // namespace cdiff::core
