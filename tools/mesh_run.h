#pragma once

#include <tufa/check.h>
#include <tufa/contour.h>
#include <tufa/extract.h>
#include <tufa/io.h>
#include <tufa/labels.h>

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "attribute_options.h"
#include "filter_options.h"

namespace tufa::tools {

/// What several grids of a file become.
enum class Join {
  Separate,  ///< a mesh each
  Union,     ///< one mesh, of the union of level sets
};

/// What faces a mesh is to have.
enum class Target {
  Any,    ///< as they are made
  Quads,  ///< triangles are joined in pairs, see tufa::pairTriangles()
};

/// What `tufa mesh` was asked for.
struct MeshArguments {
  std::string input;
  std::string output;
  std::optional<std::string> format;  ///< of standard output
  std::vector<std::string> grids;     ///< names and patterns; none: the library chooses one
  Join join = Join::Separate;
  std::optional<std::string> labels;  ///< "all", or numbers with commas between them
  bool shareInterfaces = false;       ///< of labels
  Method method = Method::Dual;
  double sharpAngle = ExtractOptions().sharpAngle;  ///< degrees; for emc and cms
  bool mergeCells = false;                          ///< of cms, by the tolerance
  std::string refine = "0";                         ///< a length; not for dual
  FilterWords filters;
  AttributeWords attributes;
  ContourOptions contour;
  std::optional<std::string> isovalue;
  std::string tolerance = "0.1";
  std::optional<std::string> toleranceGrid;
  Target target = Target::Any;
  std::optional<double> creaseAngle;  ///< degrees; unset: 40 where the field is a distance field
  UpAxis up = UpAxis::Y;
  double scale = 1;  ///< metres in a world unit
  GlbCompression compression = GlbCompression::None;
  bool allowEmpty = false;
  bool isFrame = false;  ///< of a sequence, whose frames need not have all grids
  bool check = false;
  bool json = false;
  bool quiet = false;
};

/// The mesh of one grid: what was found and how long its parts took.
struct GridRun {
  std::string grid;
  std::vector<std::string> united;  ///< the grids that it is the union of, if it is one
  std::string output;               ///< the file it went into
  double voxelSize = 1;             ///< world units
  FilterRun filters;
  Mesh mesh;
  ContourReport contour;
  std::optional<InterfaceReport> interfaces;  ///< of a label
  std::optional<CheckReport> check;
  double readSeconds = 0;
  double uniteSeconds = 0;
  double contourSeconds = 0;
  double attributeSeconds = 0;
  double checkSeconds = 0;
};

/// The meshes of one file.
struct MeshRun {
  std::vector<GridRun> grids;
  WriteReport written;
  double writeSeconds = 0;
};

/// Refuses what cannot be done, before any work. Throws Error.
void requireFeasible(const MeshArguments& arguments);

/// Reads, meshes, checks and writes.
[[nodiscard]] MeshRun meshFile(const MeshArguments& arguments);

/// What a run did, for programs: the keys of its grid, or a list of them if there are several.
[[nodiscard]] nlohmann::ordered_json toJson(const MeshRun& run, const MeshArguments& arguments);

/// The same for people: some lines of text, the last one about what was written. `minAngle`: the
/// angle that was asked for, degrees.
[[nodiscard]] std::string describe(const MeshRun& run, double minAngle);

}  // namespace tufa::tools
