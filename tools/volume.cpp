#include "volume.h"

#include <openvdb/openvdb.h>

#include <tufa/error.h>
#include <tufa/io.h>
#include <cmath>

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

}  // namespace

std::shared_ptr<openvdb::GridBase> readVolume(const std::string& file,
                                              const std::optional<std::string>& name) {
  const CrashGuard guard(file);
  return readGrid(file, name);
}

std::vector<GridInfo> describeVolumes(const std::string& file) {
  const CrashGuard guard(file);
  return describeGrids(file);
}

std::shared_ptr<const openvdb::GridBase> readToleranceGrid(const std::string& file,
                                                           const std::string& name) {
  const openvdb::GridBase::Ptr grid = readVolume(file, name);
  if (grid->isType<openvdb::FloatGrid>()) return grid;
  throw Error(ErrorCode::UnsupportedGrid, "the tolerance grid \"" + name + "\" in " + file +
                                              " holds " + grid->valueType() +
                                              " values; it must be a float grid");
}

std::string nameOf(const openvdb::GridBase& grid) { return grid.getName(); }

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
