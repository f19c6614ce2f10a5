// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "learning/checkpoint.h"

#include <cstring>

#include "core/file.h"
#include "learning/bytes.h"

namespace cdiff::learning {
namespace {

namespace fs = std::filesystem;
using core::InputError;
using nlohmann::json;

constexpr std::string_view kMagic = "CDIFFCP1";
constexpr std::size_t kDigestLength = 64;

at::Tensor takeTensor(ByteReader& reader, const std::vector<std::int64_t>& shape) {
  at::Tensor tensor = at::empty(shape, at::kFloat);
  const std::string_view bytes =
      reader.take(static_cast<std::size_t>(tensor.numel()) * sizeof(float));
  if (!bytes.empty()) std::memcpy(tensor.data_ptr(), bytes.data(), bytes.size());
  return tensor;
}

}  // namespace

const at::Tensor& Checkpoint::tensor(const std::string& name, at::IntArrayRef shape,
                                     const std::string& source) const {
  const auto found = tensors.find(name);
  if (found == tensors.end()) throw InputError(source + ": tensor '" + name + "' is missing");
  if (found->second.sizes() != shape) {
    throw InputError(source + ": tensor '" + name + "' has shape " +
                     json(found->second.sizes().vec()).dump() + ", the network of this run " +
                     json(shape.vec()).dump() +
                     ": the checkpoint is of another architecture; give another --output, or the "
                     "data and options that it was trained with");
  }
  return found->second;
}

void writeCheckpoint(const fs::path& path, const Checkpoint& checkpoint) {
  json shapes = json::array();
  for (const auto& [name, tensor] : checkpoint.tensors)
    shapes.push_back({name, tensor.sizes().vec()});
  std::string content(kMagic);
  putText(content, json{{"facts", checkpoint.facts}, {"tensors", shapes}}.dump());
  for (const auto& [name, tensor] : checkpoint.tensors) {
    const at::Tensor plain = tensor.detach().to(at::kCPU, at::kFloat).contiguous();
    content.append(static_cast<const char*>(plain.data_ptr()),
                   static_cast<std::size_t>(plain.numel()) * sizeof(float));
  }
  content += core::sha256(content);
  core::writeFileAtomically(path, content);
}

Checkpoint readCheckpoint(const fs::path& path) {
  const std::string name = "checkpoint '" + path.string() + "'";
  const std::string content = core::readFile(path, "checkpoint");
  if (content.size() < kMagic.size() + kDigestLength ||
      content.compare(0, kMagic.size(), kMagic) != 0)
    throw InputError(name + ": is not a checkpoint");
  const std::string_view body(content.data(), content.size() - kDigestLength);
  if (core::sha256(body) != content.substr(body.size()))
    throw InputError(name + ": the checksum at its end is not that of its content");
  ByteReader reader(body, name, kMagic.size());
  const json header = json::parse(reader.text(), nullptr, false);
  if (!header.is_object()) throw InputError(name + ": the header is not JSON");
  Checkpoint checkpoint;
  checkpoint.facts = header.at("facts");
  for (const json& entry : header.at("tensors"))
    checkpoint.tensors[entry.at(0)] =
        takeTensor(reader, entry.at(1).get<std::vector<std::int64_t>>());
  return checkpoint;
}

}  // namespace cdiff::learning
