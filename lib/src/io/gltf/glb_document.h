#pragma once

#include <tufa/mesh.h>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/gltf/glb.h"
#include "io/gltf/glb_streams.h"

namespace tufa::io {

/// What a .glb says of a mesh beside its vertices.
struct GlbMesh {
  std::string name;
  glb::Json primitives;
  const std::vector<Attribute>& attributes;
};

/// A .glb while it is built of streams: the document, and the bytes behind it.
class GlbDocument {
 public:
  explicit GlbDocument(GlbCompression compression) : compression_(compression) {}

  /// The document, for what this class does not add.
  [[nodiscard]] glb::Json& json() { return json_; }

  /// Adds a mesh's vertices and takes their bytes: "attributes" and, where positions move,
  /// "targets" of its primitives.
  [[nodiscard]] glb::Json addVertices(GlbStreams& streams,
                                      const std::vector<Attribute>& attributes);

  /// Adds indices and takes their bytes: a primitive for each part, of which `parts` has the
  /// numbers of indices. Empty parts are left out.
  [[nodiscard]] glb::Json addParts(const glb::Json& vertices, GlbStream& indices,
                                   std::span<const std::size_t> parts);

  /// Adds a mesh and a node that takes it to metres; gives the node's number.
  std::size_t addMesh(GlbMesh mesh, const GlbFrame& frame, const glb::Json& extras);

  /// Hands all bytes to `sink`, a function of a std::string_view. Call it once, at the end.
  template <class Sink>
  void write(Sink&& sink) {
    sink(std::string_view(finish()));
    static constexpr char kPadding[4] = {};
    for (const std::string& blob : blobs_) {
      sink(std::string_view(blob));
      sink(std::string_view(kPadding, padded(blob.size()) - blob.size()));
    }
  }

 private:
  static std::uint64_t padded(std::uint64_t bytes) { return (bytes + 3) / 4 * 4; }
  [[nodiscard]] bool packs() const { return compression_ == GlbCompression::Meshopt; }
  std::size_t addView(GlbStream& stream, bool vertices);
  std::size_t addVertices(GlbStream& stream);
  void require(const char* extension);
  [[nodiscard]] std::string finish();

  GlbCompression compression_;
  glb::Json json_ = glb::emptyDocument();
  std::vector<std::string> blobs_;
  std::uint64_t binaryBytes_ = 0;
  std::uint64_t plainBytes_ = 0;  ///< of the buffer that packed views stand for
};

}  // namespace tufa::io
