#include <tufa/io.h>
#include <tufa/memory.h>

#include <tufa/error.h>
#include <filesystem>
#include <optional>
#include <system_error>

#include "base/known_enum.h"
#include "io/mesh/mesh_format.h"
#include "io/mesh/mesh_readers.h"

namespace tufa {
namespace {

Mesh readAs(MeshFormat format, const io::InputBytes& input) {
  switch (format) {
    case MeshFormat::Ply:
      return io::readPly(input);
    case MeshFormat::Obj:
      return io::readObj(input);
    case MeshFormat::Stl:
      return io::readStl(input);
    case MeshFormat::Off:
      return io::readOff(input);
    case MeshFormat::Glb:
      return io::readGlb(input);
    case MeshFormat::Usda:
      input.fail(".usda is written, not read");
    case MeshFormat::ThreeMf:
      input.fail(".3mf is written, not read");
  }
  return {};
}

}  // namespace

Mesh readMesh(const std::filesystem::path& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) {
    throw Error(ErrorCode::UnreadableFile, "cannot read " + path.string() + ": it is a folder");
  }
  const std::optional<MeshFormat> format = io::formatOfEnding(path);
  if (!format) {
    const bool isVolume = path.extension() == ".vdb" || path.extension() == ".nvdb";
    throw Error(ErrorCode::InvalidArgument,
                "cannot tell the mesh format of " + path.string() +
                    ": meshes are read from .ply, .obj, .stl, .off and .glb" +
                    (isVolume ? "; tufa mesh makes meshes of volumes" : ""));
  }
  return readAs(*format, io::InputBytes(path));
}

Mesh readMesh(const FileBytes& file, MeshFormat format) {
  base::requireKnown(format, MeshFormat::ThreeMf, "the format");
  return readAs(format, io::InputBytes(file));
}

}  // namespace tufa
