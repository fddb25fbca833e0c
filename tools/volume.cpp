#include "volume.h"

#include <CLI/CLI.hpp>

#include <tufa/error.h>
#include <tufa/io.h>
#include <cmath>
#include <map>

#include "commands.h"
#include "console.h"
#include "crash_guard.h"
#include "number.h"

namespace tufa::tools {
namespace {

/// The promises that a mesh breaks, for a message.
std::string brokenPromises(const CheckReport& report) {
  std::string text;
  const auto add = [&](bool broken, const char* promise) {
    if (broken) text += (text.empty() ? "not " : ", not ") + std::string(promise);
  };
  add(!report.closed, "closed");
  add(!report.manifold, "manifold");
  add(!report.oriented, "oriented");
  add(report.closed && report.oriented && !report.outward, "outward");
  add(report.invalidFaces + report.duplicateFaces > 0, "free of invalid or duplicate faces");
  return text.empty() ? "it holds degenerate faces" : text;
}

/// Whether a mesh breaks no promise but to be closed, and that because the data ends.
bool openOnlyWhereDataEnds(const CheckReport& check, const ContourReport& report) {
  return report.openEdges > 0 && check.boundaryEdges > 0 && check.manifold && check.oriented &&
         check.invalidFaces + check.duplicateFaces == 0;
}

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

openvdb::GridBase::Ptr readVolume(const std::string& file, const std::optional<std::string>& name) {
  const CrashGuard guard(file);
  return readGrid(file, name);
}

void requireVoxels(const openvdb::GridBase& grid, const std::string& file) {
  if (!grid.empty()) return;
  throw Error(ErrorCode::UnsupportedGrid,
              "grid \"" + grid.getName() + "\" in " + file + " has no active voxels");
}

void requireSurface(const Mesh& mesh, double isovalue, const openvdb::GridBase& grid,
                    const std::string& file) {
  if (mesh.triangleCount() > 0) return;
  const GridInfo info = describeGrid(grid);
  std::string range = "has no finite value";
  if (info.minValue) {
    range = "has values from " + formatNumber(*info.minValue) + " to " +
            formatNumber(*info.maxValue) + " and background " + formatNumber(info.background);
  }
  throw Error(ErrorCode::UnsupportedGrid, "no surface at isovalue " + formatNumber(isovalue) +
                                              ": grid \"" + grid.getName() + "\" in " + file + " " +
                                              range);
}

double readTolerance(const std::string& option, const std::string& text,
                     const openvdb::GridBase& grid) {
  const bool world = !text.empty() && text.back() == 'w';
  const std::string number = world ? text.substr(0, text.size() - 1) : text;
  const std::optional<double> value = numberIn<double>(number);
  if (!value || !(*value >= 0)) {
    throw Error(ErrorCode::InvalidArgument,
                option +
                    " must be a number of voxels, or of world units with the suffix w, not \"" +
                    text + "\"");
  }
  return world ? *value / std::cbrt(grid.transform().voxelVolume()) : *value;
}

void addContourOptions(CLI::App& app, ContourOptions& options) {
  app.add_option("--iso", options.isovalue,
                 "value on the surface; default: 0 for level sets, else half way between the "
                 "least and the greatest value");
  addChoice<Inside>(app, "--inside", options.inside,
                    {{"auto", Inside::Auto}, {"below", Inside::Below}, {"above", Inside::Above}},
                    "which side of the isovalue is solid (default auto)");
  addChoice<Ambiguity>(app, "--ambiguity", options.ambiguity,
                       {{"separate", Ambiguity::Separate},
                        {"join", Ambiguity::Join},
                        {"asymptotic", Ambiguity::Asymptotic},
                        {"chord", Ambiguity::Chord}},
                       "rule for ambiguous cell faces (default separate)");
  addChoice<Normals>(
      app, "--normals", options.normals,
      {{"gradient", Normals::Gradient}, {"faces", Normals::Faces}, {"none", Normals::None}},
      "where the normals come from (default gradient)");
  addChoice<NonFinite>(app, "--nan", options.nonFinite,
                       {{"refuse", NonFinite::Refuse}, {"outside", NonFinite::Outside}},
                       "what to do with NaN and infinite values (default refuse)");
  app.add_flag("--cap", options.cap, "close the surface where it runs out of the data");
  app.add_flag("--simplify,!--no-simplify", options.simplify,
               "collapse edges of an adaptive mesh as far as the tolerance allows (default)");
  app.add_flag("!--no-repair", options.repair, "do not look for self-intersections");
  addThreadsOption(app, options.threads);
}

void noteData(const ContourReport& report) {
  if (report.nonFiniteValues > 0) {
    printNote("note: " + formatCount(report.nonFiniteValues) +
              " NaN or infinite values were taken as outside");
  }
  if (report.openEdges > 0) {
    printNote("note: the surface runs out of the data at " + formatCount(report.openEdges) +
              " lattice edges and is open there; --cap closes it");
  }
}

void noteBroken(const CheckReport& check, const ContourReport& report, const std::string& what) {
  if (openOnlyWhereDataEnds(check, report)) {
    printNote("note: " + what + " has " + formatCount(check.boundaryEdges) +
              " boundary edges where the data ends");
  } else {
    printNote(what + " is not watertight: " + brokenPromises(check));
  }
}

}  // namespace tufa::tools
