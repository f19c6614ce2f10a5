// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The command `cdiff export`: recorded sessions as files that other programs replay.
#include <filesystem>
#include <iostream>
#include <memory>

#include "cli/commands.h"
#include "core/markup.h"
#include "core/scratch_folder.h"
#include "e2e_cdiff/core/exceptions.h"
#include "exchange/scene_exporter.h"
#include "record/result_folder.h"
#ifdef E2E_CDIFF_WITH_ROS
#include "node_graph/bags/replay.h"
#endif

namespace cdiff::cli {
namespace {

namespace fs = std::filesystem;

struct ExportArguments {
  std::string source;
  std::string format = "openscenario";
  std::string ego = "trajectory";
  std::string output;
  exchange::SceneOptions scene;
};

exchange::ExportOptions optionsOf(const ExportArguments& arguments) {
  arguments.scene.validate();
  const bool external = arguments.ego == "external";
  if (external && arguments.format != "openscenario")
    throw core::InputError("--ego external: only --format openscenario can leave the ego open");
  return {exchange::exportFormat(arguments.format),
          external ? exchange::ExportedEgo::kExternal : exchange::ExportedEgo::kTrajectory,
          arguments.scene};
}

/// The result of a bag, made in `folder`.
void replayInto(const fs::path& bag, const fs::path& folder) {
#ifdef E2E_CDIFF_WITH_ROS
  const node_graph::ReplayResult result = node_graph::replayBag(bag, folder);
  for (const std::string& finding : result.findings)
    std::cerr << "cdiff: bag '" << bag.string() << "': " << core::plainText(finding) << "\n";
#else
  (void)folder;
  throw core::InputError("'" + bag.string() +
                         "' is a bag, which needs a build with ROS (E2E_CDIFF_ROS=ON)");
#endif
}

/// A name for the case of a result folder, also where it is given as "." or with a slash.
std::string nameOf(const fs::path& folder) {
  const fs::path whole = fs::weakly_canonical(folder);
  return whole.filename().string();
}

void exportSessions(const ExportArguments& arguments) {
  const exchange::ExportOptions options = optionsOf(arguments);
  const fs::path source = arguments.source;
  if (source.extension() == ".bag") {
    const core::ScratchFolder scratch;
    replayInto(source, scratch.path() / "result");
    exchange::SceneExporter exporter(arguments.output, options);
    std::cout << exporter.add(scratch.path() / "result", source.stem().string());
    exporter.finish();
    return;
  }
  const std::vector<fs::path> folders = record::sessionFolders(source);
  exchange::SceneExporter exporter(arguments.output, options);
  for (const fs::path& folder : folders)
    std::cout << exporter.add(folder, nameOf(folder)) << std::flush;
  exporter.finish();
}

}  // namespace

void addExportCommand(CLI::App& program, int& exit_code) {
  auto arguments = std::make_shared<ExportArguments>();
  CLI::App* command = program.add_subcommand(
      "export", "Write recorded sessions as files that other programs replay");
  command
      ->add_option("source", arguments->source,
                   "Result folder of a session or batch, a folder of result folders, or a bag")
      ->required();
  command
      ->add_option("--format", arguments->format,
                   "openscenario (1.2, with OpenDRIVE), commonroad (2020a) or csv")
      ->capture_default_str();
  command->add_option("--from", arguments->scene.from, "Start of what is exported [s]")
      ->capture_default_str();
  command->add_option("--to", arguments->scene.to, "Its end [s] (default: the session's)");
  command
      ->add_option("--vehicles", arguments->scene.vehicles,
                   "all, or some of ego, cbv and near (within 50 m of the ego at some time)")
      ->capture_default_str();
  command
      ->add_option("--ego", arguments->ego,
                   "trajectory, or external: a controller outside the file drives it")
      ->capture_default_str()
      ->check(CLI::IsMember({"trajectory", "external"}));
  command->add_option("--output", arguments->output, "Folder for the files and their index.csv")
      ->required();
  command->callback([arguments, &exit_code] {
    exportSessions(*arguments);
    exit_code = ExitCode::kPassed;
  });
}

}  // namespace cdiff::cli
