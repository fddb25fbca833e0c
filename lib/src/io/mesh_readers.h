#pragma once

#include <tufa/mesh.h>

#include "io/input_bytes.h"

namespace tufa::io {

// One format each. All throw Error(UnreadableFile) with the place where reading failed, and
// allocate no more than a small multiple of the file's size, whatever its header claims.
[[nodiscard]] Mesh readPly(const InputBytes& input);
[[nodiscard]] Mesh readObj(const InputBytes& input);
[[nodiscard]] Mesh readOff(const InputBytes& input);
[[nodiscard]] Mesh readStl(const InputBytes& input);
[[nodiscard]] Mesh readGlb(const InputBytes& input);

}  // namespace tufa::io
