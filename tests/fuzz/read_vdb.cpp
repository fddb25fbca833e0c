// Any bytes as a .vdb file: grids, or Error. A grid that is not too large is meshed.

#include <tufa/contour.h>
#include <tufa/error.h>
#include <tufa/memory.h>
#include <array>
#include <new>

#include "base/leaf_source.h"
#include "fuzz.h"
#include "grid/openvdb_templates.h"

namespace {

/// Damage can turn a small grid into one of billions of voxels, which is no fault.
bool small(const tufa::GridInfo& info) {
  constexpr std::size_t kVoxels = 20000;
  return info.meshable && info.activeVoxels <= kVoxels && info.tiles == 0;
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const tufa::FileBytes file{tufa::fuzz::viewOf(data, size)};
  try {
    (void)tufa::describeGrids(file);
    const openvdb::GridBase::Ptr grid = tufa::readGrid(file);
    tufa::GridFile stored(file);
    std::array<double, 512> values{};
    for (openvdb::Index64 n = 0; stored.leaves() && n < stored.outline()->baseTree().leafCount();
         ++n) {
      stored.leaves()->read(n, values.data());
    }
    if (!small(tufa::describeGrid(*grid))) return 0;
    tufa::ContourOptions options;
    options.nonFinite = tufa::NonFinite::Outside;
    options.threads = 1;
    (void)tufa::contour(*grid, options);
  } catch (const tufa::Error&) {
  } catch (const std::bad_alloc&) {
  }
  return 0;
}
