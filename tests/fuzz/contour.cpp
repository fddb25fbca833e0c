// Small grids of any topology and any values through contour(), uniform and adaptive. The oracle is
// the promise: a closed 2-manifold where the data is closed, the same topology at every tolerance,
// and the error as certified.

#include <tufa/contour.h>
#include <tufa/error.h>
#include <cmath>

#include "fuzz.h"
#include "grids.h"
#include "support/mesh_oracle.h"

namespace {

using tufa::fuzz::require;
using tufa::fuzz::Source;

void requirePromises(const tufa::test::MeshTopology& topology, bool closed) {
  require(topology.nonManifoldEdges == 0, "manifold edges");
  require(topology.misorientedEdges == 0, "one orientation");
  require(topology.collapsedFaces == 0, "no collapsed faces");
  if (!closed) return;
  require(topology.boundaryEdges == 0, "closed");
  require(topology.manifold(), "manifold vertices, no duplicate faces, no unused vertices");
}

/// Returns the Euler characteristic.
long long requirePromises(const tufa::Mesh& mesh, const tufa::ContourReport& report) {
  for (const tufa::Position& p : mesh.positions) {
    require(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z), "finite positions");
  }
  const tufa::test::MeshTopology topology = tufa::test::inspect(mesh);
  requirePromises(topology, report.openEdges == 0);
  if (!mesh.quads.empty()) {
    requirePromises(tufa::test::inspect(tufa::test::triangulated(mesh)), report.openEdges == 0);
  }
  return topology.euler();
}

void contourBoth(const openvdb::GridBase& grid, Source& source) {
  tufa::ContourOptions options;
  if (source.coin()) options.isovalue = (source.next() - 128) / 128.0;
  options.inside = static_cast<tufa::Inside>(source.below(3));
  options.ambiguity = static_cast<tufa::Ambiguity>(source.below(4));
  options.normals = static_cast<tufa::Normals>(source.below(3));
  options.nonFinite = tufa::NonFinite::Outside;
  options.cap = source.coin();
  options.simplify = source.coin();
  options.repair = source.coin();
  options.tolerance = source.next() / 64.0;
  options.threads = 1;
  tufa::ContourReport report;
  const tufa::Mesh adaptive = tufa::contour(grid, options, &report);
  const long long euler = requirePromises(adaptive, report);
  options.uniform = true;
  tufa::ContourReport uniformReport;
  const tufa::Mesh uniform = tufa::contour(grid, options, &uniformReport);
  const long long uniformEuler = requirePromises(uniform, uniformReport);

  require(report.openEdges == uniformReport.openEdges, "the same cut edges");
  if (uniform.positions.empty()) {
    require(adaptive.positions.empty(), "no surface, no mesh");
    return;
  }
  require(report.certificate.has_value(), "a certificate");
  constexpr double kRounding = 1e-3;  // positions are rounded to floats afterwards
  require(report.certificate->maxErrorVoxels <= options.tolerance + kRounding, "the tolerance");
  require(euler == uniformEuler, "the topology of the uniform mesh");
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Source source(data, size);
  const openvdb::GridBase::Ptr grid = tufa::fuzz::gridFrom(source);
  try {
    contourBoth(*grid, source);
  } catch (const tufa::Error& error) {
    require(error.code() == tufa::ErrorCode::UnsupportedGrid, error.what());
  }
  return 0;
}
