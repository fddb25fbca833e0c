#include <tufa/error.h>
#include <tufa/io.h>
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/single_precision.h"
#include "io/mesh/mesh_format.h"

namespace tufa {
namespace io {
namespace {

std::string lowerCase(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  return text;
}

/// Devices such as /dev/null have no ending; they get the format with the least to say.
bool isBareDevice(const std::filesystem::path& path) {
  std::error_code error;
  const auto type = std::filesystem::status(path, error).type();
  return !path.has_extension() && (type == std::filesystem::file_type::character ||
                                   type == std::filesystem::file_type::fifo);
}

}  // namespace

MeshFormat formatOf(const std::filesystem::path& path) {
  const std::string ending = lowerCase(path.extension().string());
  if (ending == ".ply") return MeshFormat::Ply;
  if (ending == ".obj") return MeshFormat::Obj;
  if (ending == ".stl") return MeshFormat::Stl;
  if (ending == ".off") return MeshFormat::Off;
  if (ending == ".glb") return MeshFormat::Glb;
  throw Error(ErrorCode::InvalidArgument, "cannot tell the mesh format of " + path.string() +
                                              ": its ending is none of .ply .obj .stl .off .glb");
}

Bounds boundsOf(const Mesh& mesh) {
  Bounds bounds;
  if (mesh.positions.empty()) return bounds;
  bounds.least = bounds.greatest = mesh.positions.front();
  for (const Position& p : mesh.positions) {
    bounds.least = {std::min(bounds.least.x, p.x), std::min(bounds.least.y, p.y),
                    std::min(bounds.least.z, p.z)};
    bounds.greatest = {std::max(bounds.greatest.x, p.x), std::max(bounds.greatest.y, p.y),
                       std::max(bounds.greatest.z, p.z)};
  }
  return bounds;
}

bool needsDoublePrecision(const Mesh& mesh) {
  return !std::all_of(mesh.positions.begin(), mesh.positions.end(),
                      [](const Position& p) { return p == base::toSingle(p); });
}

void requireAtMost(std::uint64_t limit, std::uint64_t count, const char* what, const char* format) {
  if (count <= limit) return;
  throw Error(ErrorCode::LimitExceeded, std::to_string(count) + " " + what + " are more than the " +
                                            std::to_string(limit) + " that " + format +
                                            " can hold");
}

MeshSink::MeshSink(OutputFile& file, const Mesh& mesh, const WriteOptions& options)
    : file_(file),
      progress_(options.progress),
      total_(mesh.positions.size() + mesh.normals.size() + mesh.quads.size() +
             mesh.triangles.size() + 1) {}

void MeshSink::advance(std::size_t count) {
  done_ = std::min(done_ + count, total_);
  if (!progress_) return;
  if (!progress_("writing", static_cast<double>(done_) / static_cast<double>(total_))) {
    throw Error(ErrorCode::Cancelled, "cancelled while writing");
  }
}

}  // namespace io

void requireMeshEnding(const std::filesystem::path& path) {
  if (!io::isBareDevice(path)) static_cast<void>(io::formatOf(path));
}

void write(const Mesh& mesh, const std::filesystem::path& path, const WriteOptions& options) {
  const auto format = io::isBareDevice(path) ? io::MeshFormat::Ply : io::formatOf(path);
  if (!mesh.normals.empty() && mesh.normals.size() != mesh.positions.size()) {
    throw Error(ErrorCode::InvalidArgument,
                "the mesh has " + std::to_string(mesh.normals.size()) + " normals for " +
                    std::to_string(mesh.positions.size()) + " positions");
  }
  io::OutputFile file(path);
  io::MeshSink sink(file, mesh, options);
  switch (format) {
    case io::MeshFormat::Ply:
      io::writePly(mesh, sink);
      break;
    case io::MeshFormat::Obj:
      io::writeObj(mesh, sink, options.name);
      break;
    case io::MeshFormat::Stl:
      io::writeStl(mesh, sink);
      break;
    case io::MeshFormat::Off:
      io::writeOff(mesh, sink);
      break;
    case io::MeshFormat::Glb:
      io::writeGlb(mesh, sink, options.name);
      break;
  }
  file.commit();
}

}  // namespace tufa
