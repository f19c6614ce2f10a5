// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "learning/task_data.h"

#include <ostream>

#include "e2e_cdiff/core/exceptions.h"
#include "learning/samples/scene_file.h"
#include "learning/task.h"

namespace cdiff::learning {
namespace {

namespace fs = std::filesystem;
using core::InputError;

/// The files of the data folder that the task learns from. Throws InputError naming the task and
/// what to do where there is none.
std::vector<fs::path> dataFiles(const Training& training, bool scenes) {
  try {
    return findDataFiles(training.options.data, scenes ? kSceneExtension : ".shard");
  } catch (const InputError& error) {
    throw InputError("training task '" + training.options.task +
                     "' has no samples: " + error.what() + "; collect them (cdiff collect" +
                     (scenes ? " --scenes" : "") + ") or give another --data");
  }
}

/// The samples that the task makes of scenes, as shards in memory.
std::vector<ShardReader> shardsOfScenes(const Training& training,
                                        const std::vector<fs::path>& files,
                                        const std::atomic<bool>& stop, std::ostream& log) {
  std::vector<ShardReader> shards;
  std::size_t samples = 0;
  for (const fs::path& file : files) {
    if (stop) throw core::Interrupted("stopped while samples were made of the scenes");
    const Scene scene = readScene(file);
    ShardWriter writer(training.task->sceneFields());
    const std::vector<std::uint64_t> network = {core::hashText(scene.network_source_sha256)};
    for (Sample& sample : training.task->samplesOf(scene)) {
      sample.fields[kSessionField] = network;
      writer.append(sample);
    }
    samples += writer.size();
    shards.emplace_back(writer.take({{"scene", scene.name}}), "samples of '" + file.string() + "'");
  }
  log << "data: " << samples << " samples of " << files.size() << " scenes" << std::endl;
  return shards;
}

void requireFields(const Training& training, const Dataset& dataset) {
  const std::string who = "training task '" + training.options.task + "'";
  const std::vector<std::string> fields = training.task->fields();
  if (fields.empty()) {
    throw InputError(who +
                     " learns from no field of the samples; its fields() in "
                     "planners/NAME/training must name them");
  }
  for (const std::string& field : fields) {
    if (dataset.schema().find(field) != nullptr) continue;
    throw InputError(who + " needs the field '" + field + "' of the samples, which " +
                     dataset.name() + " lacks (it holds " + dataset.schema().names() +
                     "); collect samples with that field, or give another --task");
  }
}

}  // namespace

Dataset readData(const Training& training, const std::atomic<bool>& stop, std::ostream& log) {
  const TrainingOptions& options = training.options;
  const bool scenes = !training.task->sceneFields().fields.empty();
  const std::vector<fs::path> files = dataFiles(training, scenes);
  Dataset dataset =
      scenes ? Dataset(shardsOfScenes(training, files, stop, log),
                       "data folder '" + options.data + "'", options.validation_share, "networks")
             : Dataset(options.data, options.validation_share);
  requireFields(training, dataset);
  return dataset;
}

}  // namespace cdiff::learning
