#include "volume.h"

#include <fnmatch.h>
#include <openvdb/openvdb.h>

#include <tufa/error.h>
#include <tufa/io.h>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numeric>
#include <system_error>

#include "console.h"
#include "crash_guard.h"
#include "frames.h"
#include "number.h"
#include "open_edges.h"
#include "paths.h"
#include "standard_streams.h"

namespace tufa::tools {
namespace {

/// Of a level set, that the samples around the surface end with the band.
void noteEdgeOfBand(const openvdb::GridBase& grid, double isovalue) {
  double background = 0;
  grid.apply<openvdb::RealGridTypes>(
      [&](const auto& typed) { background = static_cast<double>(typed.background()); });
  const double toEdge = std::abs(background) - std::abs(isovalue);
  if (isovalue == 0 || toEdge <= 0 || toEdge >= voxelSizeOf(grid)) return;
  printNote("note: the surface at isovalue " + formatNumber(isovalue) +
            " is less than a voxel from the edge of the narrow band of " +
            shownGrid(grid.getName()) + ", where it has steps; a wider band has none");
}

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

/// "has values from 0 to 3 and background 0", for a message.
std::string describeValues(const GridInfo& info) {
  if (!info.minValue) return "has no finite value";
  return "has values from " + formatNumber(*info.minValue) + " to " + formatNumber(*info.maxValue) +
         " and background " + formatNumber(info.background);
}

/// An isovalue to begin with: a tenth of the greatest value, which shows the body of most smoke.
std::string suggestIsovalue(const GridInfo& info) {
  const double greatest = std::max(info.maxValue.value_or(0), info.background);
  return greatest > 0 ? "--iso " + shortNumber(0.1 * greatest) : "a value between these";
}

/// What makes a volume of a file of another kind, by its ending; empty for a .vdb and what is not
/// known.
std::string commandFor(const std::string& file) {
  const std::string ending = endingOf(file);
  const auto isOneOf = [&](std::initializer_list<const char*> endings) {
    return std::find(endings.begin(), endings.end(), ending) != endings.end();
  };
  if (isOneOf({".ply", ".obj", ".stl", ".off", ".glb"})) {
    return "tufa voxelize makes a volume of a mesh";
  }
  if (isOneOf({".mhd", ".mha", ".nrrd", ".nii", ".png", ".tif", ".tiff", ".raw", ".dcm"})) {
    return "tufa import makes a volume of images";
  }
  return ending == ".json" ? "tufa model makes a volume of a scene" : "";
}

/// Calls read() with a file, or with the bytes of standard input, under a CrashGuard.
template <class Read>
auto guarded(const std::string& file, Read&& read) {
  if (!isStandard(file)) {
    const CrashGuard guard(file);
    try {
      return namingPipes(file, [&] { return read(std::filesystem::path(file)); });
    } catch (const Error& error) {
      const std::string other = commandFor(file);
      if (error.code() != ErrorCode::UnreadableFile || other.empty()) throw;
      throw Error(error.code(), std::string(error.what()) + "; " + other);
    }
  }
  const FileBytes bytes = standardInput();
  const CrashGuard guard(bytes.name);
  return read(bytes);
}

std::vector<GridName> listVolume(const std::string& file) {
  return guarded(file, [](const auto& source) { return listGrids(source); });
}

/// Throws Error(InvalidArgument) if a file is not there whose name stands for a sequence.
void requireVolume(const std::string& file) {
  std::error_code error;
  if (std::filesystem::exists(std::filesystem::path(file) / "chunks.json", error)) {
    throw Error(ErrorCode::InvalidArgument,
                file + " is a folder of chunks: tufa chunks --assemble " + file +
                    " --lods all:0 -o MESH makes one mesh of them");
  }
  if (isStandard(file) || std::filesystem::exists(file, error)) return;
  if (namesFrames(file)) {
    throw Error(ErrorCode::InvalidArgument,
                file + " stands for a sequence, and only tufa mesh takes one; name a single frame");
  }
  if (const std::string hashes = framesInAnotherWay(file); !hashes.empty()) {
    throw Error(ErrorCode::InvalidArgument, "there is no file " + file +
                                                "; a sequence is named with # for each digit of "
                                                "the frame's number: " +
                                                hashes);
  }
}

/// Throws Error(InvalidArgument) as requireVolume(), and if a pattern stands where one grid is
/// named.
void requireGridName(const std::string& file, const std::optional<std::string>& given) {
  requireVolume(file);
  if (!given || given->find_first_of("*?") == std::string::npos) return;
  const std::string& name = *given;
  std::string names;
  for (const GridName& grid : listVolume(file)) {
    if (grid.name == name) return;
    names += (names.empty() ? "\"" : ", \"") + grid.name + "\"";
  }
  throw Error(ErrorCode::InvalidArgument,
              "\"" + name + "\" is a pattern, and the name of one grid is wanted; " +
                  shownInput(file) + " holds " + names);
}

}  // namespace

std::optional<double> readIsovalue(const std::optional<std::string>& text,
                                   const openvdb::GridBase& grid, const std::string& file) {
  if (text) {
    if (*text == "auto") return std::nullopt;
    if (const auto value = numberIn<double>(*text)) return value;
    throw Error(ErrorCode::InvalidArgument, "--iso is a number or auto, not \"" + *text + "\"");
  }
  if (!lacksIsovalue(text, grid)) return std::nullopt;
  const GridInfo info = describeGrid(grid);
  if (!info.minValue) {
    throw Error(ErrorCode::InvalidArgument, "a fog volume needs --iso, and grid \"" +
                                                grid.getName() + "\" in " + shownInput(file) +
                                                " has no values that could tell a good one; "
                                                "tufa info on a frame that has some does");
  }
  throw Error(ErrorCode::InvalidArgument,
              "a fog volume needs --iso: grid \"" + grid.getName() + "\" in " + shownInput(file) +
                  " " + describeValues(info) + "; try " + suggestIsovalue(info) +
                  ", or --iso auto for half way between the least and the greatest value, which "
                  "differs from frame to frame");
}

bool lacksIsovalue(const std::optional<std::string>& text, const openvdb::GridBase& grid) {
  return !text && grid.getGridClass() == openvdb::GRID_FOG_VOLUME;
}

void noteIsovalue(const std::optional<std::string>& text, const openvdb::GridBase& grid,
                  double isovalue) {
  if (isLevelSet(grid)) return noteEdgeOfBand(grid, isovalue);
  if (text && *text != "auto") return;
  printNote("note: isovalue " + formatNumber(isovalue) + " was taken for " +
            shownGrid(grid.getName()) + ", half way between the least and the greatest value");
}

std::vector<std::string> chooseGrids(const std::string& file,
                                     const std::vector<std::string>& patterns, Lacking lacking) {
  const std::vector<GridName> grids = listVolume(file);
  std::vector<bool> chosen(grids.size());
  std::string unknown;
  for (const std::string& pattern : patterns) {
    const bool exact = pattern.find_first_of("*?") == std::string::npos;
    bool found = false;
    for (std::size_t i = 0; i < grids.size(); ++i) {
      // The first of several grids of a name can be named without its number.
      const std::string& name = grids[i].name;
      const bool means =
          exact ? name == pattern || (!found && name == pattern + "[0]")
                : grids[i].meshable && fnmatch(pattern.c_str(), name.c_str(), FNM_NOESCAPE) == 0;
      if (!means) continue;
      chosen[i] = found = true;
    }
    if (found || !unknown.empty()) continue;
    unknown = std::string(exact ? "no grid \"" : "no grid that can be meshed is named like \"") +
              pattern + "\" in " + shownInput(file) + "; it holds ";
    for (const GridName& grid : grids) {
      unknown += (&grid == grids.data() ? "\"" : ", \"") + grid.name + "\"";
    }
  }
  const bool isAny = std::find(chosen.begin(), chosen.end(), true) != chosen.end();
  if (!unknown.empty() && (lacking == Lacking::Refuse || !isAny)) {
    throw Error(ErrorCode::UnknownGrid, unknown);
  }
  std::vector<std::string> names;
  for (std::size_t i = 0; i < grids.size(); ++i) {
    if (chosen[i]) names.push_back(grids[i].name);
  }
  return names;
}

void noteChoice(const std::string& file, const std::string& grid) {
  const std::vector<GridName> grids = listVolume(file);
  const auto count = std::count_if(grids.begin(), grids.end(),
                                   [](const GridName& candidate) { return candidate.meshable; });
  if (count < 2) return;
  printNote("note: grid \"" + grid + "\" was taken, one of " + std::to_string(count) +
            " that can be meshed; --grid chooses");
}

void requireVoxelSize(const std::string& option, double size) {
  if (!(size > 0 && std::isfinite(size))) {
    throw Error(ErrorCode::InvalidArgument,
                option + ": the voxel size must be above 0, not " + formatNumber(size));
  }
  try {
    static_cast<void>(openvdb::math::Transform::createLinearTransform(size));
  } catch (const openvdb::Exception&) {
    throw Error(ErrorCode::InvalidArgument, option + ": OpenVDB takes no voxels of size " +
                                                formatNumber(size) +
                                                "; their volume is rounded to 0");
  }
}

std::shared_ptr<openvdb::GridBase> readVolume(const std::string& file,
                                              const std::optional<std::string>& name) {
  requireGridName(file, name);
  return guarded(file, [&](const auto& source) { return readGrid(source, name); });
}

GridFile openVolume(const std::string& file, const std::optional<std::string>& name) {
  requireGridName(file, name);
  return guarded(file, [&](const auto& source) { return GridFile(source, name); });
}

std::shared_ptr<openvdb::GridBase> loadVolume(GridFile& volume, const std::string& file) {
  const CrashGuard guard(file);
  return volume.load();
}

std::vector<GridInfo> describeVolumes(const std::string& file) {
  return guarded(file, [](const auto& source) { return describeGrids(source); });
}

bool holdsLabels(const GridInfo& info) {
  return info.valueType == "int32" || info.valueType == "int64";
}

std::shared_ptr<const openvdb::GridBase> readToleranceGrid(const std::string& file,
                                                           const std::string& name) {
  const openvdb::GridBase::Ptr grid = readVolume(file, name);
  if (grid->isType<openvdb::FloatGrid>()) return grid;
  throw Error(ErrorCode::UnsupportedGrid, "the tolerance grid \"" + name + "\" in " +
                                              shownInput(file) + " holds " + grid->valueType() +
                                              " values; it must be a float grid");
}

std::string nameOf(const openvdb::GridBase& grid) { return grid.getName(); }

void requireVoxels(const openvdb::GridBase& grid, const std::string& file) {
  if (!grid.empty()) return;
  throw Error(ErrorCode::UnsupportedGrid,
              "grid \"" + grid.getName() + "\" in " + shownInput(file) + " has no active voxels");
}

void requireSurface(const Mesh& mesh, double isovalue, const openvdb::GridBase& grid,
                    const std::string& file, const std::string& filters) {
  if (mesh.triangleCount() > 0) return;
  const GridInfo info = describeGrid(grid);
  const auto reaches = [&](const std::optional<double>& value, bool above) {
    return value && (above ? *value >= isovalue : *value < isovalue);
  };
  // Between the values of active voxels there is none, but between them and the background.
  const bool isAbove = reaches(info.minValue, true), isBelow = reaches(info.maxValue, false);
  const bool runsOut =
      (isAbove && info.background < isovalue) || (isBelow && info.background >= isovalue);
  const bool isFog = isovalue == 0 && isLevelSet(grid) && info.background == 0 && info.minValue &&
                     *info.minValue >= 0;
  throw Error(ErrorCode::UnsupportedGrid,
              "no surface at isovalue " + formatNumber(isovalue) + ": grid \"" + grid.getName() +
                  "\" in " + shownInput(file) + " " + describeValues(info) +
                  (filters.empty() ? "" : " after" + filters) +
                  (runsOut ? "; it runs out of the data, where --cap of tufa mesh closes it" : "") +
                  (isFog ? "; that is a fog volume, which needs --iso, not a level set" : ""));
}

std::optional<Length> lengthIn(const std::string& text) {
  const bool world = !text.empty() && (text.back() == 'w' || text.back() == 'W');
  const std::string number = world ? text.substr(0, text.size() - 1) : text;
  const std::optional<double> value = numberIn<double>(number);
  if (!value || !std::isfinite(*value)) return std::nullopt;
  return Length{*value, world};
}

bool isLevelSet(const openvdb::GridBase& grid) {
  return grid.getGridClass() == openvdb::GRID_LEVEL_SET;
}

double voxelSizeOf(const openvdb::GridBase& grid) {
  return std::cbrt(std::abs(grid.transform().voxelVolume()));
}

double readTolerance(const std::string& option, const std::string& text,
                     const openvdb::GridBase& grid) {
  const std::optional<Length> length = lengthIn(text);
  if (!length || !(length->value >= 0)) {
    throw Error(ErrorCode::InvalidArgument,
                option +
                    " must be a number of voxels, 0 or more, or of world units with the suffix w, "
                    "not \"" +
                    text + "\"");
  }
  return length->world ? length->value / voxelSizeOf(grid) : length->value;
}

void noteData(const ContourReport& report, const Mesh* mesh) {
  if (report.nonFiniteValues > 0) {
    printNote("note: " + formatCount(report.nonFiniteValues) +
              " NaN or infinite values were taken as outside");
  }
  if (report.openEdges > 0 && (mesh == nullptr || countOpenEdges(*mesh) > 0)) {
    printNote("note: the surface runs out of the data at " + formatCount(report.openEdges) +
              " lattice edges and is open there; --cap closes it");
  }
}

void noteBroken(const CheckReport& check, const ContourReport& report, const std::string& what) {
  if (openOnlyWhereDataEnds(check, report)) {
    printNote("note: " + what + " has " + formatCount(check.boundaryEdges) +
              " boundary edges where the data ends");
  } else {
    const bool isInsideOut = check.closed && check.oriented && !check.outward && check.volume < 0;
    printNote(what + " is not watertight: " + brokenPromises(check) +
              (isInsideOut ? "; --inside says which side of the isovalue is solid" : ""));
  }
}

}  // namespace tufa::tools
