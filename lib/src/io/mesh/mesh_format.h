#pragma once

#include <tufa/io.h>
#include <tufa/mesh.h>
#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "io/output_file.h"
#include "shading/shaded_mesh.h"

namespace tufa::io {

using shading::ShadedMesh;

/// The format that a file's ending says, if any.
[[nodiscard]] std::optional<MeshFormat> formatOfEnding(const std::filesystem::path& path);

/// The corners of the box around all positions; both zero for an empty mesh.
struct Bounds {
  Position least{0, 0, 0};
  Position greatest{0, 0, 0};
};
[[nodiscard]] Bounds boundsOf(const Mesh& mesh);

/// Writes bytes to a file and reports progress of the whole.
class MeshSink {
 public:
  /// `total` positions, normals and faces are to come; `begin` of the whole call is done already.
  MeshSink(OutputFile& file, std::size_t total, double begin, const Progress& progress);

  void write(const void* data, std::size_t size) { file_.write(data, size); }

  /// Reports that `count` more positions, normals or faces are written. Throws Error(Cancelled).
  void advance(std::size_t count);

  /// Reports that all is written, before the file takes its place. Throws Error(Cancelled).
  void finish();

  /// Items to write between two calls of advance().
  static constexpr std::size_t kStride = 65536;

 private:
  void report();

  OutputFile& file_;
  const Progress& progress_;
  double begin_ = 0;
  std::size_t done_ = 0;
  std::size_t total_ = 0;
};

/// Calls body(item) for all items of an array, with progress in between.
template <class Items, class Body>
void forEachItem(MeshSink& sink, const Items& items, Body&& body) {
  std::size_t done = 0;
  for (const auto& item : items) {
    body(item);
    if (++done % MeshSink::kStride == 0) sink.advance(MeshSink::kStride);
  }
  sink.advance(done % MeshSink::kStride);
}

/// One mesh of a file that may hold several.
struct MeshPart {
  const Mesh* mesh = nullptr;
  std::string name;
  std::optional<ShadedMesh> shaded;  ///< if its normals are split at creases
};

/// What a file says of its meshes as a whole.
struct FileFrame {
  std::string name;  ///< of what holds them all
  UpAxis up = UpAxis::Y;
  double scale = 1;  ///< metres in a world unit
};

/// Throws Error(InvalidArgument) for an axis that is none, or a scale that is not above 0.
void requireSoundFrame(const FileFrame& frame);

// One format each.
void writePly(const Mesh& mesh, MeshSink& sink);
void writeOff(const Mesh& mesh, MeshSink& sink);
void writeStl(const Mesh& mesh, MeshSink& sink);
void writeObj(std::span<const MeshPart> parts, MeshSink& sink);
void writeGlb(std::span<const MeshPart> parts, const FileFrame& frame, MeshSink& sink);
/// In 16 bits where they tell all vertices of a mesh apart; else its name goes into the report.
void writeCompactGlb(std::span<const MeshPart> parts, const FileFrame& frame,
                     GlbCompression compression, MeshSink& sink, WriteReport& report);
void writeUsda(std::span<const MeshPart> parts, const FileFrame& frame, MeshSink& sink);
/// In millimetres, or micrometres where a world unit is small. Throws Error(InvalidArgument) where
/// has3mf() says that there is no lib3mf.
void write3mf(std::span<const MeshPart> parts, const FileFrame& frame, MeshSink& sink);
[[nodiscard]] bool has3mf();
/// The elements of arrays that a part has in .usda: what its writer tells MeshSink::advance().
[[nodiscard]] std::size_t usdaItems(const MeshPart& part);
/// As variants of one prim, the finest first.
void writeUsdaLods(std::span<const MeshPart> levels, const FileFrame& frame, MeshSink& sink);

}  // namespace tufa::io
