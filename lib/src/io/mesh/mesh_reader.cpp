#include <tufa/io.h>

#include "io/mesh/mesh_format.h"
#include "io/mesh/mesh_readers.h"

namespace tufa {
namespace {

Mesh readAs(io::MeshFormat format, const io::InputBytes& input) {
  switch (format) {
    case io::MeshFormat::Ply:
      return io::readPly(input);
    case io::MeshFormat::Obj:
      return io::readObj(input);
    case io::MeshFormat::Stl:
      return io::readStl(input);
    case io::MeshFormat::Off:
      return io::readOff(input);
    case io::MeshFormat::Glb:
      return io::readGlb(input);
  }
  return {};
}

}  // namespace

Mesh readMesh(const std::filesystem::path& path) {
  const io::MeshFormat format = io::formatOf(path);
  return readAs(format, io::InputBytes(path));
}

}  // namespace tufa
