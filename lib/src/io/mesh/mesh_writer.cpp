#include <tufa/error.h>
#include <tufa/io.h>
#include <tufa/memory.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "base/job.h"
#include "base/known_enum.h"
#include "base/number_text.h"
#include "base/parallel.h"
#include "base/part_of_progress.h"
#include "base/require_mesh.h"
#include "io/input_bytes.h"
#include "io/mesh/file_attributes.h"
#include "io/mesh/float_precision.h"
#include "io/mesh/mesh_format.h"

namespace tufa {
namespace io {
namespace {

/// Devices such as /dev/null have no ending; they get the format with the least to say.
bool isBareDevice(const std::filesystem::path& path) {
  std::error_code error;
  const auto type = std::filesystem::status(path, error).type();
  return !path.has_extension() && (type == std::filesystem::file_type::character ||
                                   type == std::filesystem::file_type::fifo);
}

}  // namespace

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

void requireSoundFrame(const FileFrame& frame) {
  base::requireKnown(frame.up, UpAxis::Z, "the axis that points up");
  if (frame.scale > 0 && std::isfinite(frame.scale)) return;
  throw Error(ErrorCode::InvalidArgument, "the scale must be above 0");
}

MeshSink::MeshSink(OutputFile& file, std::size_t total, double begin, const Progress& progress)
    : file_(file), progress_(progress), begin_(begin), total_(total + 1) {}

void MeshSink::advance(std::size_t count) {
  done_ = std::min(done_ + count, total_);
  report();
}

void MeshSink::finish() {
  done_ = total_;
  report();
}

void MeshSink::report() {
  if (!progress_) return;
  const double share = static_cast<double>(done_) / static_cast<double>(total_);
  bool goesOn = true;
  base::runIsolated([&] { goesOn = progress_("writing", begin_ + (1 - begin_) * share); });
  if (!goesOn) throw Error(ErrorCode::Cancelled, "cancelled while writing");
}

namespace {

/// The share of a call that splitting at creases takes; the rest goes into bytes.
constexpr double kShadingEnd = 0.4;

/// .3mf has bounds of its own.
bool hasFloatsOnly(MeshFormat format) {
  return format == MeshFormat::Stl || format == MeshFormat::Glb || format == MeshFormat::Usda;
}

/// Returns how far writing moves a position at most, world units.
double requireSound(const MeshPart& part, MeshFormat format, const WriteOptions& options) {
  const Mesh& mesh = *part.mesh;
  base::requireFaces(mesh);
  base::requireFinite(mesh);
  if (hasFloatsOnly(format)) requireFloatRange(mesh);
  requireSoundAttributes(mesh.attributes, mesh.positions.size(), format == MeshFormat::Glb);
  base::requireNormals(mesh);
  if (format == MeshFormat::Stl) return requireFloatsEnough(mesh, {0, 0, 0}, ".stl");
  const bool isGlb = format == MeshFormat::Glb && options.compression == GlbCompression::None;
  if (!isGlb && format != MeshFormat::Usda) return 0;
  return requireFloatsEnough(mesh, floatOrigin(mesh), isGlb ? ".glb" : ".usda");
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
  base::Job job(options.threads, base::partOf(options.progress, 0, kShadingEnd));
  job.run([&] {
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const auto done = static_cast<double>(i + 1) / static_cast<double>(parts.size());
      job.beginStage("normals", done);
      if (!splits(parts[i], options)) continue;
      parts[i].shaded = shading::splitAtCreases(*parts[i].mesh, options.creaseAngle, job);
    }
    job.finish();
  });
  return kShadingEnd;
}

bool hasNormalsAtCorners(MeshFormat format) {
  return format == MeshFormat::Obj || format == MeshFormat::Glb || format == MeshFormat::Usda;
}

bool holdsSeveral(MeshFormat format) {
  return hasNormalsAtCorners(format) || format == MeshFormat::ThreeMf;
}

void requireFormat(MeshFormat format) {
  if (hasFormat(format)) return;
  throw Error(ErrorCode::InvalidArgument,
              "this build of Tufa has no lib3mf, which writes .3mf; write .stl or another format");
}

/// What a format's writer tells MeshSink::advance() of a part.
std::size_t itemsOf(const MeshPart& part, MeshFormat format) {
  if (format == MeshFormat::Usda) return usdaItems(part);
  const Mesh& mesh = *part.mesh;
  const std::size_t faces = mesh.quads.size() + mesh.triangles.size();
  if (format == MeshFormat::Stl) return faces;
  if (hasNormalsAtCorners(format)) return mesh.positions.size() + mesh.normals.size() + faces;
  return mesh.positions.size() + faces;
}

/// Writes to an open file. Returns what writeCompactGlb() reports.
WriteReport writeTo(OutputFile& file, std::span<MeshPart> parts, MeshFormat format,
                    const WriteOptions& options) {
  const double begin = hasNormalsAtCorners(format) ? splitNormals(parts, options) : 0;
  std::size_t total = 0;
  for (const MeshPart& part : parts) total += itemsOf(part, format);
  const FileFrame frame{options.name, options.up, options.scale};
  MeshSink sink(file, total, begin, options.progress);
  WriteReport found;
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
      if (options.compression == GlbCompression::None) {
        writeGlb(parts, frame, sink);
      } else {
        writeCompactGlb(parts, frame, options.compression, sink, found);
      }
      break;
    case MeshFormat::Usda:
      writeUsda(parts, frame, sink);
      break;
    case MeshFormat::ThreeMf:
      write3mf(parts, frame, sink);
      break;
  }
  sink.finish();
  file.commit();
  return found;
}

/// `open()` opens what is written to, once the options are known to be sound.
template <class Open>
void writeParts(std::span<MeshPart> parts, MeshFormat format, const WriteOptions& options,
                WriteReport* report, Open&& open) {
  if (!(options.creaseAngle >= 0 && options.creaseAngle <= 180)) {
    throw Error(ErrorCode::InvalidArgument, "the crease angle must be between 0 and 180 degrees");
  }
  requireFormat(format);
  requireSoundFrame({options.name, options.up, options.scale});
  base::requireKnown(options.compression, GlbCompression::Meshopt, "the compression");
  double rounding = 0;
  for (const MeshPart& part : parts) {
    rounding = std::max(rounding, requireSound(part, format, options));
  }
  WriteReport found;
  base::Job(options.threads, {}).run([&] {
    OutputFile file(open());
    found = writeTo(file, parts, format, options);
  });
  found.rounding = std::max(found.rounding, rounding);
  if (report != nullptr) *report = std::move(found);
}

/// Throws Error(InvalidArgument) if the format does not hold several meshes.
std::vector<MeshPart> partsOf(const std::vector<NamedMesh>& meshes, MeshFormat format,
                              const std::string& target) {
  if (!holdsSeveral(format)) {
    throw Error(ErrorCode::InvalidArgument,
                target + ": of the formats only .glb, .obj, .usda and .3mf hold several meshes");
  }
  std::vector<MeshPart> parts;
  for (const NamedMesh& named : meshes) parts.push_back({&named.mesh, named.name, {}});
  return parts;
}

}  // namespace

std::optional<MeshFormat> formatOfEnding(const std::filesystem::path& path) {
  const std::string ending = path.extension().string();
  const auto names = meshFormatNames();
  for (std::size_t i = 0; i < names.size() && !ending.empty(); ++i) {
    if (sameWord(std::string_view(ending).substr(1), names[i])) return static_cast<MeshFormat>(i);
  }
  return {};
}

}  // namespace io

std::span<const std::string_view> meshFormatNames() {
  static constexpr std::array<std::string_view, 7> names = {"ply", "obj",  "stl", "off",
                                                            "glb", "usda", "3mf"};
  return names;
}

bool hasFormat(MeshFormat format) {
  base::requireKnown(format, MeshFormat::ThreeMf, "the format");
  return format != MeshFormat::ThreeMf || io::has3mf();
}

MeshFormat meshFormatOf(const std::filesystem::path& path) {
  if (const auto format = io::formatOfEnding(path)) return *format;
  std::string all;
  for (const std::string_view name : meshFormatNames()) all.append(" .").append(name);
  throw Error(ErrorCode::InvalidArgument,
              "cannot tell the mesh format of " + path.string() + ": its ending is none of" + all);
}

void requireMeshEnding(const std::filesystem::path& path) {
  if (!io::isBareDevice(path)) static_cast<void>(meshFormatOf(path));
}

void write(const Mesh& mesh, const std::filesystem::path& path, const WriteOptions& options,
           WriteReport* report) {
  const auto format = io::isBareDevice(path) ? MeshFormat::Ply : meshFormatOf(path);
  io::MeshPart part{&mesh, options.name, {}};
  io::writeParts({&part, 1}, format, options, report, [&] { return io::OutputFile(path); });
}

void write(const Mesh& mesh, std::ostream& stream, MeshFormat format, const WriteOptions& options,
           WriteReport* report) {
  base::requireKnown(format, MeshFormat::ThreeMf, "the format");
  io::MeshPart part{&mesh, options.name, {}};
  io::writeParts({&part, 1}, format, options, report, [&] { return io::OutputFile(stream); });
}

void writeMeshes(const std::vector<NamedMesh>& meshes, const std::filesystem::path& path,
                 const WriteOptions& options, WriteReport* report) {
  std::vector<io::MeshPart> parts = io::partsOf(meshes, meshFormatOf(path), path.string());
  io::writeParts(parts, meshFormatOf(path), options, report, [&] { return io::OutputFile(path); });
}

void writeMeshes(const std::vector<NamedMesh>& meshes, std::ostream& stream, MeshFormat format,
                 const WriteOptions& options, WriteReport* report) {
  std::vector<io::MeshPart> parts = io::partsOf(meshes, format, "the stream");
  io::writeParts(parts, format, options, report, [&] { return io::OutputFile(stream); });
}

}  // namespace tufa
