// .glb: meshes of triangles in 16 bits, packed or not, under a node each.

#include <algorithm>
#include <array>
#include <vector>

#include "io/gltf/glb_document.h"
#include "io/gltf/glb_streams.h"
#include "io/mesh/float_precision.h"
#include "io/mesh/mesh_format.h"

namespace tufa::io {

void writeCompactGlb(std::span<const MeshPart> parts, const FileFrame& frame,
                     GlbCompression compression, MeshSink& sink, WriteReport& report) {
  const GlbPacking packing{compression, frame.up, frame.scale};
  std::vector<const Mesh*> meshes;
  for (const MeshPart& part : parts) meshes.push_back(part.mesh);
  const std::vector<GlbFrame> frames = framesFor(meshes, packing);
  GlbDocument document(compression);
  for (const MeshPart& part : parts) {
    const Mesh& mesh = *part.mesh;
    if (mesh.triangleCount() == 0) continue;
    ShadedMesh shaded = part.shaded ? *part.shaded : shading::unsplit(mesh);
    const std::array<std::size_t, 1> whole{shaded.indices.size()};
    shading::orderForGraphics(shaded, whole);
    GlbStreams streams = encode(mesh, shaded, frames, packing, [&] { sink.advance(0); });
    if (!streams.frame.quantized) {
      report.floatMeshes.push_back(part.name);
      report.rounding = std::max(
          report.rounding, requireFloatsEnough(mesh, originOf(streams.frame, frame.up), ".glb"));
    }
    const glb::Json vertices = document.addVertices(streams, mesh.attributes);
    const std::size_t node = document.addMesh(
        {part.name, document.addParts(vertices, streams.indices, whole), mesh.attributes},
        streams.frame, {});
    document.json()["scenes"][0]["nodes"].push_back(node);
    sink.advance(mesh.positions.size() + mesh.normals.size() + mesh.quads.size() +
                 mesh.triangles.size());
  }
  document.write([&](std::string_view bytes) { sink.write(bytes.data(), bytes.size()); });
}

}  // namespace tufa::io
