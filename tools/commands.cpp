#include "commands.h"

#include <CLI/CLI.hpp>

#include <tufa/version.h>
#include <string>

namespace tufa::tools {

void declareCommand(CLI::App& app, Command& chosen) {
  app.name("tufa");
  app.description("Watertight 2-manifold meshes from sparse OpenVDB volumes");
  app.set_version_flag("--version", std::string("tufa ") + tufa::version());
  app.require_subcommand(1);
  addMakeCommand(app, chosen);
  addVoxelizeCommand(app, chosen);
  addInfoCommand(app, chosen);
  addMeshCommand(app, chosen);
  addLodCommand(app, chosen);
  addChunksCommand(app, chosen);
  addCheckCommand(app, chosen);
}

void addThreadsOption(CLI::App& app, int& threads) {
  constexpr int kMost = 4096;
  app.add_option("--threads", threads, "most threads, 0: all")
      ->check(CLI::Range(0, kMost))
      ->capture_default_str();
}

}  // namespace tufa::tools
