// Any bytes, as a mesh file of the format TUFA_FUZZ_READER reads: a mesh whose faces name its
// vertices, or Error(UnreadableFile).

#include <tufa/error.h>
#include <tufa/memory.h>
#include <cmath>

#include "fuzz.h"
#include "io/mesh/mesh_readers.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using tufa::fuzz::require;
  const tufa::FileBytes file{tufa::fuzz::viewOf(data, size)};
  try {
    const tufa::Mesh mesh = tufa::io::TUFA_FUZZ_READER(tufa::io::InputBytes(file));
    for (const tufa::Position& p : mesh.positions) {
      require(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z), "finite positions");
    }
    for (const tufa::Triangle& triangle : tufa::triangulate(mesh)) {
      for (const tufa::VertexIndex v : triangle.vertices) {
        require(v < mesh.positions.size(), "faces name vertices");
      }
    }
  } catch (const tufa::Error& error) {
    require(error.code() == tufa::ErrorCode::UnreadableFile, "UnreadableFile");
  }
  return 0;
}
