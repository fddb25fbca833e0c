// In place of write_3mf.cpp where there is no lib3mf.

#include <tufa/error.h>

#include "io/mesh/mesh_format.h"

namespace tufa::io {

bool has3mf() { return false; }

void write3mf(std::span<const MeshPart>, const FileFrame&, MeshSink&) {
  throw Error(ErrorCode::InvalidArgument, "this build of Tufa has no lib3mf, which writes .3mf");
}

}  // namespace tufa::io
