#include <tufa/error.h>
#include <tufa/io.h>
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/job.h"
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

MeshSink::MeshSink(OutputFile& file, std::size_t total, double begin, const Progress& progress)
    : file_(file), progress_(progress), begin_(begin), total_(total + 1) {}

void MeshSink::advance(std::size_t count) {
  done_ = std::min(done_ + count, total_);
  if (!progress_) return;
  const double share = static_cast<double>(done_) / static_cast<double>(total_);
  if (!progress_("writing", begin_ + (1 - begin_) * share)) {
    throw Error(ErrorCode::Cancelled, "cancelled while writing");
  }
}

namespace {

/// The share of a call that splitting at creases takes; the rest goes into bytes.
constexpr double kShadingEnd = 0.4;

void requireSound(const MeshPart& part) {
  const Mesh& mesh = *part.mesh;
  if (mesh.normals.empty() || mesh.normals.size() == mesh.positions.size()) return;
  throw Error(ErrorCode::InvalidArgument, "the mesh has " + std::to_string(mesh.normals.size()) +
                                              " normals for " +
                                              std::to_string(mesh.positions.size()) + " positions");
}

bool splits(const MeshPart& part, const WriteOptions& options) {
  return options.creaseAngle < 180 && !part.mesh->normals.empty();
}

/// Splits the normals of those parts that have some; returns the share of the call that took.
double splitNormals(std::span<MeshPart> parts, const WriteOptions& options) {
  if (std::none_of(parts.begin(), parts.end(),
                   [&](const MeshPart& part) { return splits(part, options); })) {
    return 0;
  }
  base::Job job(options.threads, options.progress);
  job.run([&] {
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const auto done = static_cast<double>(i + 1) / static_cast<double>(parts.size());
      job.beginStage("normals", kShadingEnd * done);
      if (!splits(parts[i], options)) continue;
      parts[i].shaded = splitAtCreases(*parts[i].mesh, options.creaseAngle, job);
    }
    job.finish();
  });
  return kShadingEnd;
}

bool hasNormalsAtCorners(MeshFormat format) {
  return format == MeshFormat::Obj || format == MeshFormat::Glb;
}

void writeParts(std::span<MeshPart> parts, MeshFormat format, const std::filesystem::path& path,
                const WriteOptions& options) {
  if (!(options.creaseAngle >= 0 && options.creaseAngle <= 180)) {
    throw Error(ErrorCode::InvalidArgument, "the crease angle must be between 0 and 180 degrees");
  }
  std::size_t total = 0;
  for (const MeshPart& part : parts) {
    requireSound(part);
    const Mesh& mesh = *part.mesh;
    total +=
        mesh.positions.size() + mesh.normals.size() + mesh.quads.size() + mesh.triangles.size();
  }
  OutputFile file(path);
  const double begin = hasNormalsAtCorners(format) ? splitNormals(parts, options) : 0;
  MeshSink sink(file, total, begin, options.progress);
  switch (format) {
    case MeshFormat::Ply:
      writePly(*parts.front().mesh, sink);
      break;
    case MeshFormat::Obj:
      writeObj(parts, sink);
      break;
    case MeshFormat::Stl:
      writeStl(*parts.front().mesh, sink);
      break;
    case MeshFormat::Off:
      writeOff(*parts.front().mesh, sink);
      break;
    case MeshFormat::Glb:
      writeGlb(parts, sink);
      break;
  }
  file.commit();
}

}  // namespace
}  // namespace io

void requireMeshEnding(const std::filesystem::path& path) {
  if (!io::isBareDevice(path)) static_cast<void>(io::formatOf(path));
}

void write(const Mesh& mesh, const std::filesystem::path& path, const WriteOptions& options) {
  const auto format = io::isBareDevice(path) ? io::MeshFormat::Ply : io::formatOf(path);
  io::MeshPart part{&mesh, options.name, {}};
  io::writeParts({&part, 1}, format, path, options);
}

void writeMeshes(const std::vector<NamedMesh>& meshes, const std::filesystem::path& path,
                 const WriteOptions& options) {
  const auto format = io::formatOf(path);
  if (!io::hasNormalsAtCorners(format)) {
    throw Error(ErrorCode::InvalidArgument,
                path.string() + ": of the formats only .glb and .obj hold several meshes");
  }
  std::vector<io::MeshPart> parts;
  for (const NamedMesh& named : meshes) parts.push_back({&named.mesh, named.name, {}});
  io::writeParts(parts, format, path, options);
}

}  // namespace tufa
