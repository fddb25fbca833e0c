#include "commands.h"

#include <CLI/CLI.hpp>

#include <tufa/version.h>
#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "console.h"
#include "number.h"
#include "usage.h"
#include "volume.h"

namespace tufa::tools {
namespace {

/// An option whose value is one of some names.
template <class Enum>
void addChoice(CLI::App& app, const std::string& name, Enum& value,
               const std::map<std::string, Enum>& choices, const std::string& help) {
  std::vector<std::string> names;
  for (const auto& [choice, number] : choices) names.push_back(choice);
  app.add_option_function<std::string>(
         name, [&value, choices](const std::string& choice) { value = choices.at(choice); }, help)
      ->check(CLI::IsMember(names));
}

}  // namespace

void declareCommand(CLI::App& app, Command& chosen) {
  app.name("tufa");
  app.description("Watertight 2-manifold meshes from sparse OpenVDB volumes");
  app.set_version_flag("--version", std::string("tufa ") + tufa::version());
  app.require_subcommand(1);
  nameFlagsAsTyped(app);
  addMakeCommand(app, chosen);
  addVoxelizeCommand(app, chosen);
  addModelCommand(app, chosen);
  addImportCommand(app, chosen);
  addPictureCommand(app, chosen);
  addInfoCommand(app, chosen);
  addAdviseCommand(app, chosen);
  addFilterCommand(app, chosen);
  addMeshCommand(app, chosen);
  addLodCommand(app, chosen);
  addChunksCommand(app, chosen);
  addCheckCommand(app, chosen);
  addCompareCommand(app, chosen);
  addRepairCommand(app, chosen);
  addFitCommand(app, chosen);
  addHelpCommand(app, chosen);
}

void addHelpCommand(CLI::App& app, Command& chosen) {
  const auto name = std::make_shared<std::string>();
  std::string names;
  for (const CLI::App* const command : app.get_subcommands({})) {
    names += (names.empty() ? "" : ",") + command->get_name();
  }
  CLI::App* const help = app.add_subcommand("help", "Print the options of a subcommand");
  help->add_option("SUBCOMMAND", *name, "which one; none: all of them in short")
      ->type_name("TEXT:{" + names + "}");
  help->callback(
      [&app, &chosen, name] { chosen = [&app, name] { return printHelp(helpOf(app, *name)); }; });
}

CLI::Validator above0() {
  return {[](std::string& text) {
            const auto number = numberIn<double>(text);
            if (number && *number > 0 && std::isfinite(*number)) return std::string();
            return text + " is not a number above 0";
          },
          "NUMBER > 0"};
}

CLI::Validator wholeNumberFrom(std::size_t least) {
  return {[least](std::string& text) {
            const auto number = numberIn<std::size_t>(text);
            if (number && *number >= least) return std::string();
            return text + " is not a whole number, " + std::to_string(least) + " or more";
          },
          "INT >= " + std::to_string(least)};
}

CLI::Validator wholeNumberIn(std::size_t least, std::size_t most) {
  const std::string from = std::to_string(least), to = std::to_string(most);
  return {[=](std::string& text) {
            const auto number = numberIn<std::size_t>(text);
            if (number && *number >= least && *number <= most) return std::string();
            return text + " is not a whole number from " + from + " to " + to;
          },
          "INT in [" + from + " - " + to + "]"};
}

void addThreadsOption(CLI::App& app, int& threads) {
  constexpr int kMost = 4096;
  app.add_option("--threads", threads, "most threads, 0: all")
      ->check(wholeNumberIn(0, kMost))
      ->capture_default_str();
}

CLI::Option* addIsovalueOption(CLI::App& app, std::optional<std::string>& isovalue) {
  return app.add_option(
      "--iso", isovalue,
      "value on the surface; default: 0 for level sets; fog volumes need one, or "
      "auto: half way between the least and the greatest value, 0 for level sets");
}

void addInsideOption(CLI::App& app, Inside& inside) {
  addChoice<Inside>(app, "--inside", inside,
                    {{"auto", Inside::Auto}, {"below", Inside::Below}, {"above", Inside::Above}},
                    "which side of the isovalue is solid (default auto)");
}

void addNonFiniteOption(CLI::App& app, NonFinite& nonFinite) {
  addChoice<NonFinite>(app, "--nan", nonFinite,
                       {{"refuse", NonFinite::Refuse}, {"outside", NonFinite::Outside}},
                       "what to do with NaN and infinite values (default refuse)");
}

void addFrameOptions(CLI::App& app, UpAxis& up, double& scale, const std::string& formats) {
  addChoice<UpAxis>(app, "--up", up, {{"y", UpAxis::Y}, {"z", UpAxis::Z}},
                    formats + ": axis of the volume that points up (default y)");
  app.add_option("--scale", scale, formats + ": metres in a world unit")
      ->check(above0())
      ->capture_default_str();
}

void addCompressionOptions(CLI::App& app, GlbCompression& compression) {
  app.add_flag_callback(
      "--quantize",
      [&compression] { compression = std::max(compression, GlbCompression::Quantized); },
      ".glb: positions in 16 bits, normals in 8 (KHR_mesh_quantization)");
  app.add_flag_callback(
      "--compress", [&compression] { compression = GlbCompression::Meshopt; },
      ".glb: the same and packed (EXT_meshopt_compression)");
}

void noteFloats(const std::string& what) {
  printNote("note: " + what + " is stored in floats: 16 bits do not tell all its vertices apart");
}

void noteRounding(double rounding, double voxelSize) {
  constexpr double kSeen = 0.01;
  if (!(rounding > kSeen * voxelSize)) return;
  printNote("note: the file has single precision, which moves vertices by up to " +
            shortNumber(rounding / voxelSize) +
            " voxels beyond the certified error; .ply, .obj and .off have double precision");
}

void addContourOptions(CLI::App& app, ContourOptions& options, std::optional<std::string>& isovalue,
                       bool methods) {
  addIsovalueOption(app, isovalue);
  addInsideOption(app, options.inside);
  std::map<std::string, Ambiguity> rules{{"separate", Ambiguity::Separate},
                                         {"join", Ambiguity::Join},
                                         {"asymptotic", Ambiguity::Asymptotic},
                                         {"chord", Ambiguity::Chord}};
  std::string help = "rule for ambiguous cell faces (default separate)";
  if (methods) {
    rules["original"] = Ambiguity::Original;
    help += "; original, which may leave holes, is for --method mc alone";
  }
  addChoice<Ambiguity>(app, "--ambiguity", options.ambiguity, rules, help);
  addChoice<Normals>(
      app, "--normals", options.normals,
      {{"gradient", Normals::Gradient}, {"faces", Normals::Faces}, {"none", Normals::None}},
      "where the normals come from (default gradient)");
  addNonFiniteOption(app, options.nonFinite);
  app.add_flag("--cap", options.cap, "close the surface where it runs out of the data");
  app.add_flag(
      "--simplify,!--no-simplify,!--fast", options.simplify,
      "collapse edges of an adaptive mesh as far as the tolerance allows (default); --fast, "
      "the same as --no-simplify: merge cells alone, in about half the time");
  app.add_option("--min-angle", options.minAngle,
                 "angle that triangles are to keep, in degrees up to 30, for more triangles; what "
                 "is left below is told; 0: none asked for")
      ->check(CLI::Range(0.0, 30.0))
      ->capture_default_str();
  app.add_flag("!--no-repair", options.repair, "do not look for self-intersections");
  app.add_option("--tile-faces", options.tileFaces,
                 "most faces of voxels on the surface between tiles; more take gigabytes")
      ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{1} << 40))
      ->capture_default_str();
  addThreadsOption(app, options.threads);
}

}  // namespace tufa::tools
