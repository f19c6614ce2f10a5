// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include <functional>
#include <new>

#include "diffusion/model.h"
#include "inference/weight_file_text.h"

namespace cdiff::diffusion {
namespace {

using test::littleEndian;
using test::weightFile;

constexpr std::uint64_t kMebibyte = std::uint64_t{1} << 20;
/// Address space that a child may take on top of what it starts with: the header's 8 MiB as text
/// and as JSON, one piece of the file, the error.
constexpr std::uint64_t kAllowance = 64 * kMebibyte;

std::uint64_t addressSpace() {
  std::ifstream file("/proc/self/statm");
  std::uint64_t pages = 0;
  file >> pages;
  return pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

enum Outcome { kNoError = 10, kRefused = 11, kOtherError = 12, kOutOfMemory = 13, kNoLimit = 14 };

Outcome outcomeOf(const std::function<void()>& action, const std::string& expected) {
  try {
    action();
  } catch (const core::InputError& error) {
    const bool found = std::string(error.what()).find(expected) != std::string::npos;
    if (!found) std::fprintf(stderr, "%s\n", error.what());
    return found ? kRefused : kOtherError;
  } catch (const std::bad_alloc&) {
    return kOutOfMemory;
  }
  return kNoError;
}

/// What the action does in a child of this process with kAllowance of memory.
int outcomeInChild(const std::function<void()>& action, const std::string& expected = "") {
  const pid_t child = ::fork();
  if (child == 0) {
    const rlim_t most = addressSpace() + kAllowance;
    const rlimit limit{most, most};
    if (::setrlimit(RLIMIT_AS, &limit) != 0) ::_exit(kNoLimit);
    ::_exit(outcomeOf(action, expected));
  }
  int status = 0;
  if (::waitpid(child, &status, 0) != child || !WIFEXITED(status)) return -1;
  return WEXITSTATUS(status);
}

class SafetensorsMemory : public ::testing::Test {
 protected:
  /// Of the file that must hold "a" of shape [2], or of that shape.
  int outcomeOfFile(const std::string& expected, const std::vector<std::int64_t>& shape = {2}) {
    return outcomeInChild(
        [&] {
          inference::readSafetensors(file_, [&](const std::map<std::string, std::string>&) {
            return std::vector<inference::TensorShape>{{"a", shape}};
          });
        },
        expected);
  }
  /// Length, header and nothing but a hole up to `size` bytes of data; false where the file system
  /// holds no such file.
  bool writeSparse(const std::string& header, std::uint64_t size) {
    test::writeBytes(file_, weightFile(header, ""));
    return ::truncate(file_.c_str(), static_cast<off_t>(8 + header.size() + size)) == 0;
  }
  /// A header of tensor "a" with F32 elements, its checksum that of other bytes.
  static std::string headerOf(std::uint64_t elements) {
    const std::string count = std::to_string(elements);
    return "{\"__metadata__\":{\"sha256\":\"" + core::sha256("other") +
           "\"},\"a\":{\"dtype\":\"F32\",\"shape\":[" + count + "],\"data_offsets\":[0," +
           std::to_string(4 * elements) + "]}}";
  }

  test::TemporaryFolder folder_;
  std::filesystem::path file_ = folder_.path() / "file.safetensors";
};

TEST_F(SafetensorsMemory, TheLimitActs) {
  const auto take = [](std::uint64_t bytes) {
    return [bytes] {
      const std::string taken(bytes, 'x');
      throw core::InputError(taken.substr(bytes - 1));
    };
  };
  EXPECT_EQ(outcomeInChild(take(kAllowance + kMebibyte), "x"), kOutOfMemory);
  EXPECT_EQ(outcomeInChild(take(kAllowance / 2), "x"), kRefused);
}

TEST_F(SafetensorsMemory, HugeDeclaredSizes) {
  const std::uint64_t huge = std::uint64_t{1} << 40;
  test::writeBytes(file_, weightFile(headerOf(huge), ""));
  EXPECT_EQ(outcomeOfFile("truncated: the tensors need 4398046511104 bytes",
                          {static_cast<std::int64_t>(huge)}),
            kRefused);
  test::writeBytes(file_, littleEndian(std::uint64_t{1} << 62) + "{}");
  EXPECT_EQ(outcomeOfFile("header's length 4611686018427387904 exceeds"), kRefused);
}

TEST_F(SafetensorsMemory, HeaderOfTheLongestLength) {
  std::string many = "\"x0\":1";
  for (int i = 1; many.size() < (8u << 20) - 32; ++i) many += ",\"x" + std::to_string(i) + "\":1";
  test::writeBytes(file_, weightFile("{" + many + "}", ""));
  EXPECT_EQ(outcomeOfFile("more than 65536 values"), kRefused);
  test::writeBytes(file_, weightFile("{\"a\":" + std::string((8u << 20) - 10, '['), ""));
  EXPECT_EQ(outcomeOfFile("the JSON has a fault"), kRefused);
}

TEST_F(SafetensorsMemory, SparseFileOf200Gibibytes) {
  const std::uint64_t elements = std::uint64_t{50} << 30;
  if (!writeSparse(headerOf(elements), 4 * elements)) {
    GTEST_SKIP() << "no file of 200 GiB can be made in " << folder_.path();
  }
  EXPECT_EQ(outcomeOfFile("tensor 'a' has shape [53687091200]; [2] was expected"), kRefused);
  EXPECT_EQ(outcomeOfFile("data section of 214748364800 bytes exceeds the limit",
                          {static_cast<std::int64_t>(elements)}),
            kRefused);
}

TEST_F(SafetensorsMemory, DamagedFileIsRefusedBeforeItsTensorsTakeMemory) {
  const std::uint64_t elements = 64 * kMebibyte;  // 256 MiB
  ASSERT_TRUE(writeSparse(headerOf(elements), 4 * elements));
  EXPECT_EQ(outcomeOfFile("the file is damaged", {static_cast<std::int64_t>(elements)}), kRefused);
}

/// A folder whose denoiser file has the sizes that its own metadata asks for: 4096 channels.
TEST_F(SafetensorsMemory, ModelThatDeclaresHugeNetworks) {
  Architecture sizes;
  sizes.channels = {4096, 4096, 4096};
  std::uint64_t end = 0;
  std::string header;
  for (const inference::TensorShape& tensor : denoiserTensors(sizes)) {
    std::uint64_t bytes = 2;
    std::string shape;
    for (const std::int64_t size : tensor.shape) {
      bytes *= static_cast<std::uint64_t>(size);
      shape += (shape.empty() ? "" : ",") + std::to_string(size);
    }
    header += ",\"" + tensor.name + "\":{\"dtype\":\"F16\",\"shape\":[" + shape +
              "],\"data_offsets\":[" + std::to_string(end) + "," + std::to_string(end + bytes) +
              "]}";
    end += bytes;
  }
  std::string row = "[1";
  for (int i = 1; i < 7; ++i) row += ",1";
  std::string rows = row + "]";
  for (int i = 1; i < 32; ++i) rows += "," + row + "]";
  const auto quoted = [](const std::string& json) {
    std::string text;
    for (const char c : json) text += c == '"' ? std::string("\\\"") : std::string(1, c);
    return "\"" + text + "\"";
  };
  file_ = folder_.path() / "denoiser.safetensors";
  ASSERT_TRUE(writeSparse(
      "{\"__metadata__\":{\"format\":\"e2e_cdiff.denoiser.1\",\"sha256\":\"" +
          core::sha256("other") + "\",\"architecture\":" + quoted(sizes.toJson()) +
          ",\"normalizer\":" + quoted("{\"mean\":[" + rows + "],\"scale\":[" + rows + "]}") +
          ",\"spread\":" + quoted("[" + rows + "]") + "}" + header + "}",
      end));
  EXPECT_GT(end, std::uint64_t{4} << 30);
  EXPECT_EQ(
      outcomeInChild([&] { diffusion::loadModel(folder_.path().string()); }, "exceeds the limit"),
      kRefused);
}

}  // namespace
}  // namespace cdiff::diffusion
