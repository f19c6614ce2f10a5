// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "learning/training_folder.h"

#include <algorithm>
#include <cstring>
#include <filesystem>

#include "core/file.h"
#include "core/json_file.h"
#include "core/output_folder.h"
#include "e2e_cdiff/core/exceptions.h"
#include "learning/samples/field.h"

namespace cdiff::learning {
namespace {

namespace fs = std::filesystem;
using core::InputError;
using nlohmann::json;

constexpr std::string_view kCheckpointMagic = "CDIFFCP1";

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
  std::string content(kCheckpointMagic);
  putText(content, json{{"facts", checkpoint.facts}, {"tensors", shapes}}.dump());
  for (const auto& [name, tensor] : checkpoint.tensors) {
    const at::Tensor plain = tensor.detach().to(at::kCPU, at::kFloat).contiguous();
    content.append(static_cast<const char*>(plain.data_ptr()),
                   static_cast<std::size_t>(plain.numel()) * sizeof(float));
  }
  content += core::sha256(content);
  core::writeOwnFile(path, content);
}

Checkpoint readCheckpoint(const fs::path& path) {
  const std::string name = "checkpoint '" + path.string() + "'";
  const std::string content = core::readFile(path, "checkpoint");
  if (content.size() < kCheckpointMagic.size() + core::kSha256Digits ||
      content.compare(0, kCheckpointMagic.size(), kCheckpointMagic) != 0)
    throw InputError(name + ": is not a checkpoint");
  const std::string_view body(content.data(), content.size() - core::kSha256Digits);
  if (core::sha256(body) != content.substr(body.size()))
    throw InputError(name + ": the checksum at its end is not that of its content");
  ByteReader reader(body, name, kCheckpointMagic.size());
  const std::string_view text = reader.text();
  core::requireShallowJson(text, name);
  const json header = json::parse(text, nullptr, false);
  if (!header.is_object()) throw InputError(name + ": the header is not JSON");
  Checkpoint checkpoint;
  checkpoint.facts = header.at("facts");
  for (const json& entry : header.at("tensors"))
    checkpoint.tensors[entry.at(0)] =
        takeTensor(reader, entry.at(1).get<std::vector<std::int64_t>>());
  return checkpoint;
}

namespace {

using Names = std::vector<std::string>;

/// What every task leaves, beside its own files.
const Names kRecords = {"training.json", "model_card.md", "curves.csv", "training.html"};

Names allStages(const Task& task) {
  Names names;
  for (const StageInfo& stage : task.stages()) names.push_back(stage.name);
  return names;
}

bool hasCheckpoint(const TrainingOptions& options, const std::string& stage) {
  return fs::exists(checkpointPath(options.output, stage));
}

bool hasAny(const TrainingOptions& options, const Names& stages) {
  return std::any_of(stages.begin(), stages.end(),
                     [&](const std::string& stage) { return hasCheckpoint(options, stage); });
}

/// Stages that the run trains again. Those of an earlier training that `all` leaves out count, too:
/// its later stages would start from them.
Names trainedStages(const Training& training) {
  const std::string& stage = training.options.stage;
  if (stage == "all") return allStages(*training.task);
  return stage == "export" ? Names{} : Names{stage};
}

/// What a training of this task may write.
Names ownFiles(const Task& task) {
  Names names = kRecords;
  for (const Names& files : {task.weightFiles(), task.otherFiles()})
    names.insert(names.end(), files.begin(), files.end());
  for (const std::string& stage : allStages(task))
    names.push_back(checkpointPath("", stage).string());
  return names;
}

}  // namespace

fs::path checkpointPath(const std::string& output, const std::string& stage) {
  return fs::path(output) / (stage + ".checkpoint");
}

std::vector<PartSource> sourcesOf(const Task& task, const std::string& stage) {
  if (stage == "export") return task.model();
  for (const StageInfo& info : task.stages()) {
    if (info.name == stage) return info.starts;
  }
  return {};
}

void requireSources(const Training& training) {
  const TrainingOptions& options = training.options;
  if (!options.init.empty()) return;
  for (const PartSource& source : sourcesOf(*training.task, options.stage)) {
    if (source.first.empty() || hasAny(options, source.stages)) continue;
    throw InputError("training: '" + options.output + "' holds no checkpoint of " + source.what +
                     "; train stage '" + source.first + "' first, or give a model with init");
  }
}

void requireFreeOutput(const Training& training) {
  const TrainingOptions& options = training.options;
  core::OutputFolder::requireFree(options.output, ownFiles(*training.task));
  if (options.overwrite) return;
  const std::string folder = "'" + options.output + "'";
  for (const std::string& stage : trainedStages(training)) {
    if (options.resume || !hasCheckpoint(options, stage)) continue;
    throw InputError(folder + " holds a training of stage '" + stage + "' (" + stage +
                     ".checkpoint); go on with it (--resume), replace it (--overwrite), or give "
                     "another --output");
  }
  if (hasAny(options, allStages(*training.task))) return;
  for (const std::string& file : training.task->weightFiles()) {
    if (!fs::exists(fs::path(options.output) / file)) continue;
    throw InputError(folder + " holds a model (" + file +
                     ") without the checkpoints of its training; replace it (--overwrite), or "
                     "give another --output");
  }
}

void removeEarlier(const Training& training) {
  const TrainingOptions& options = training.options;
  if (!options.overwrite) return;
  core::OutputFolder output(options.output);
  for (const std::string& stage : trainedStages(training))
    output.remove({checkpointPath("", stage).string()});
  if (options.stage != "all") return;
  for (const std::string& name : ownFiles(*training.task)) output.remove({name});
}

}  // namespace cdiff::learning
