#pragma once

#include <tufa/mesh.h>
#include <cstdint>
#include <vector>

#include "io/input_bytes.h"

namespace tufa::io {

// One format each. All throw Error(UnreadableFile) with the place where reading failed, and
// allocate no more than a small multiple of the file's size, whatever its header claims.
/// `parts` gets the property `part` of every face that has one as a uchar.
[[nodiscard]] Mesh readPly(const InputBytes& input, std::vector<std::uint8_t>* parts = nullptr);
[[nodiscard]] Mesh readObj(const InputBytes& input);
[[nodiscard]] Mesh readOff(const InputBytes& input);
[[nodiscard]] Mesh readStl(const InputBytes& input);
[[nodiscard]] Mesh readGlb(const InputBytes& input);

}  // namespace tufa::io
