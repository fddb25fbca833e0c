// Small grids of any topology and any values through contour(), uniform and adaptive. The oracle is
// the promise: a closed 2-manifold where the data is closed, the same topology at every tolerance,
// and the error as certified. TUFA_FUZZ_SIDE is the most samples along an edge of a grid: with few,
// thirty times as many grids go through in the same time, and one fault in a cell shows as well.

#include <tufa/contour.h>
#include <tufa/error.h>
#include <array>
#include <cmath>
#include <limits>

#include "fuzz.h"
#include "grid/openvdb_templates.h"
#include "support/mesh_oracle.h"

namespace {

using tufa::fuzz::require;

/// Hands out the input byte by byte, and, when it has ended, bytes that follow from it.
class Source {
 public:
  Source(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}

  int below(int bound) { return next() % bound; }
  bool coin() { return next() % 2 != 0; }
  int next() {
    if (at_ < size_) {
      state_ = (state_ ^ data_[at_]) * 0x9E3779B97F4A7C15u;
      return data_[at_++];
    }
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    return static_cast<int>(state_ >> 56);
  }

 private:
  const std::uint8_t* data_;
  std::size_t size_;
  std::size_t at_ = 0;
  std::uint64_t state_ = 1;
};

template <class Value>
Value valueFrom(Source& source, bool wild) {
  using Limits = std::numeric_limits<Value>;
  const std::array<Value, 16> special{Value(0),
                                      Value(-0.0),
                                      Value(1),
                                      Value(-1),
                                      Value(0.5),
                                      Value(-0.5),
                                      Limits::denorm_min(),
                                      -Limits::denorm_min(),
                                      Limits::min(),
                                      -Limits::min(),
                                      Limits::epsilon(),
                                      Value(1e30),
                                      Value(-1e30),
                                      Limits::quiet_NaN(),
                                      Limits::infinity(),
                                      -Limits::infinity()};
  if (wild && source.coin()) return special[static_cast<std::size_t>(source.below(16))];
  return static_cast<Value>((source.next() - 128) / 64.0);
}

template <class GridT>
typename GridT::Ptr gridFrom(Source& source) {
  using Value = typename GridT::ValueType;
  constexpr int kSmallest = 2;
  constexpr int kSizes = TUFA_FUZZ_SIDE - kSmallest + 1;
  constexpr bool kHasTiles = TUFA_FUZZ_SIDE >= 8;
  const bool wild = source.coin();
  auto grid = GridT::create(source.coin() ? Value(3) : Value(-3));
  const openvdb::Coord first(source.below(16) - 8, source.below(16) - 8, source.below(16) - 8);
  const int sizes[3] = {kSmallest + source.below(kSizes), kSmallest + source.below(kSizes),
                        kSmallest + source.below(kSizes)};
  for (int tiles = kHasTiles ? source.below(3) : 0; tiles > 0; --tiles) {
    const openvdb::Coord at((source.below(4) - 2) * 8, (source.below(4) - 2) * 8,
                            (source.below(4) - 2) * 8);
    grid->tree().addTile(1, at, valueFrom<Value>(source, wild), source.coin());
  }
  const int holes = source.below(4);  // of four samples, how many are missing or inactive
  auto accessor = grid->getAccessor();
  const openvdb::CoordBBox box(first, first.offsetBy(sizes[0] - 1, sizes[1] - 1, sizes[2] - 1));
  for (auto at = box.begin(); at; ++at) {
    const Value value = valueFrom<Value>(source, wild);
    if (holes > 0 && source.below(8) < holes) {
      if (source.coin()) accessor.setValueOff(*at, value);
    } else {
      accessor.setValue(*at, value);
    }
  }
  constexpr std::array kClasses{openvdb::GRID_UNKNOWN, openvdb::GRID_LEVEL_SET,
                                openvdb::GRID_FOG_VOLUME};
  grid->setGridClass(kClasses[static_cast<std::size_t>(source.below(3))]);
  openvdb::math::Mat4d matrix = openvdb::math::Mat4d::identity();
  if (source.coin()) {
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) {
        matrix[row][column] = (source.next() - 128) / 128.0;
      }
      matrix[3][row] = std::ldexp(source.next() - 128, source.below(20));
    }
  }
  // OpenVDB itself refuses matrices that flatten space.
  if (std::abs(matrix.getMat3().det()) > 1e-3) {
    grid->setTransform(openvdb::math::Transform::createLinearTransform(matrix));
  }
  return grid;
}

void requirePromises(const tufa::Mesh& mesh, const tufa::ContourReport& report) {
  for (const tufa::Position& p : mesh.positions) {
    require(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z), "finite positions");
  }
  for (const tufa::Mesh& faces : {mesh, tufa::test::triangulated(mesh)}) {
    const tufa::test::MeshTopology topology = tufa::test::inspect(faces);
    require(topology.nonManifoldEdges == 0, "manifold edges");
    require(topology.misorientedEdges == 0, "one orientation");
    require(topology.collapsedFaces == 0, "no collapsed faces");
    if (report.openEdges > 0) continue;
    require(topology.boundaryEdges == 0, "closed");
    require(topology.manifold(), "manifold vertices, no duplicate faces, no unused vertices");
  }
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
  requirePromises(adaptive, report);
  options.uniform = true;
  tufa::ContourReport uniformReport;
  const tufa::Mesh uniform = tufa::contour(grid, options, &uniformReport);
  requirePromises(uniform, uniformReport);

  require(report.openEdges == uniformReport.openEdges, "the same cut edges");
  if (uniform.positions.empty()) {
    require(adaptive.positions.empty(), "no surface, no mesh");
    return;
  }
  require(report.certificate.has_value(), "a certificate");
  constexpr double kRounding = 1e-3;  // positions are rounded to floats afterwards
  require(report.certificate->maxErrorVoxels <= options.tolerance + kRounding, "the tolerance");
  require(tufa::test::inspect(adaptive).euler() == tufa::test::inspect(uniform).euler(),
          "the topology of the uniform mesh");
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  openvdb::initialize();
  Source source(data, size);
  openvdb::GridBase::Ptr grid;
  if (source.coin()) {
    grid = gridFrom<openvdb::FloatGrid>(source);
  } else {
    grid = gridFrom<openvdb::DoubleGrid>(source);
  }
  try {
    contourBoth(*grid, source);
  } catch (const tufa::Error& error) {
    require(error.code() == tufa::ErrorCode::UnsupportedGrid, error.what());
  }
  return 0;
}
