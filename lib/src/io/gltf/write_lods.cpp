#include <tufa/error.h>
#include <tufa/io.h>
#include <tufa/lod.h>
#include <tufa/memory.h>
#include <cmath>

#include "base/job.h"
#include "base/known_enum.h"
#include "io/gltf/glb.h"
#include "io/gltf/lod_streams.h"
#include "io/mesh/file_attributes.h"
#include "io/mesh/mesh_format.h"

namespace tufa {
namespace io {
namespace {

using glb::Json;

void requireInRange(const LodWriteOptions& options) {
  if (!(options.creaseAngle >= 0 && options.creaseAngle <= 180)) {
    throw Error(ErrorCode::InvalidArgument, "the crease angle must be between 0 and 180 degrees");
  }
  requireSoundFrame(FileFrame{options.name, options.up, options.scale});
  base::requireKnown(options.compression, LodCompression::Meshopt, "the compression");
}

/// Builds a .glb of some LODs: the document, and the bytes behind it.
class LodDocument {
 public:
  LodDocument(const LodChain& chain, const LodWriteOptions& options)
      : chain_(chain), options_(options) {}

  void addLevel(std::size_t level, LodStreams streams) {
    Json accessors = addAccessors(streams, chain_.levels[level].mesh.attributes);
    const std::string name = options_.name + "_LOD" + std::to_string(level);
    const Json extras = extrasOf(level, streams);
    const std::size_t mesh = glb::add(
        json_, "meshes",
        {{"name", name}, {"primitives", Json::array({std::move(accessors)})}, {"extras", extras}});
    Json node = {{"name", name}, {"mesh", mesh}};
    const LodFrame& frame = streams.frame;
    if (frame.translation != std::array<double, 3>{0, 0, 0}) {
      node["translation"] = frame.translation;
    }
    if (frame.nodeScale != 1) {
      node["scale"] = {frame.nodeScale, frame.nodeScale, frame.nodeScale};
    }
    node["extras"] = extras;
    glb::add(json_, "nodes", std::move(node));
    levels_.push_back(level);
    blobs_.push_back(std::move(streams.positions.bytes));
    blobs_.push_back(std::move(streams.normals.bytes));
    for (LodStream& attribute : streams.attributes) blobs_.push_back(std::move(attribute.bytes));
    blobs_.push_back(std::move(streams.indices.bytes));
  }

  void write(OutputFile& file) {
    finish();
    const std::string head = glb::head(json_, binaryBytes_);
    file.write(head.data(), head.size());
    const std::uint32_t padding = 0;
    for (const std::string& blob : blobs_) {
      file.write(blob.data(), blob.size());
      file.write(&padding, padded(blob.size()) - blob.size());
    }
  }

 private:
  static std::uint64_t padded(std::uint64_t bytes) { return (bytes + 3) / 4 * 4; }

  [[nodiscard]] bool packs() const { return options_.compression == LodCompression::Meshopt; }

  /// Adds the view of a stream. A packed one names a buffer without data, which tells the unpacked
  /// size; its bytes come from the packed data.
  std::size_t addView(const LodStream& stream, bool vertices) {
    const std::uint64_t plain = stream.stride * stream.count;
    Json view = {{"buffer", packs() ? 1 : 0},
                 {"byteOffset", packs() ? plainBytes_ : binaryBytes_},
                 {"byteLength", plain}};
    if (vertices) view["byteStride"] = stream.stride;
    view["target"] = vertices ? glb::kArrayBuffer : glb::kElementArrayBuffer;
    if (packs()) {
      view["extensions"]["EXT_meshopt_compression"] = {
          {"buffer", 0},
          {"byteOffset", binaryBytes_},
          {"byteLength", stream.bytes.size()},
          {"byteStride", stream.stride},
          {"count", stream.count},
          {"mode", vertices ? "ATTRIBUTES" : "TRIANGLES"}};
    }
    binaryBytes_ += padded(stream.bytes.size());
    plainBytes_ += padded(plain);
    return glb::add(json_, "bufferViews", std::move(view));
  }

  std::size_t addAccessor(const LodStream& stream, bool vertices) {
    Json accessor = {{"bufferView", addView(stream, vertices)},
                     {"componentType", stream.componentType},
                     {"count", stream.count},
                     {"type", stream.type}};
    if (vertices && stream.componentType != glb::kFloat) accessor["normalized"] = true;
    return glb::add(json_, "accessors", std::move(accessor));
  }

  /// The primitive of an LOD.
  Json addAccessors(const LodStreams& streams, const std::vector<Attribute>& attributes) {
    const std::size_t positions = addAccessor(streams.positions, true);
    json_["accessors"][positions]["min"] = streams.least;
    json_["accessors"][positions]["max"] = streams.greatest;
    Json names = {{"POSITION", positions}, {"NORMAL", addAccessor(streams.normals, true)}};
    for (std::size_t i = 0; i < attributes.size(); ++i) {
      names[gltfName(attributes, i)] = addAccessor(streams.attributes[i], true);
    }
    const std::size_t indices = addAccessor(streams.indices, false);
    return {{"attributes", names}, {"indices", indices}, {"mode", 4}};
  }

  [[nodiscard]] Json extrasOf(std::size_t level, const LodStreams& streams) const {
    const Lod& lod = chain_.levels[level];
    const double metres = chain_.voxelSize * options_.scale;
    Json extras = {{"level", level},
                   {"triangles", lod.mesh.triangleCount()},
                   {"vertices", streams.positions.count},
                   {"tolerance_voxels", lod.tolerance},
                   {"max_error_voxels", lod.certificate.maxErrorVoxels},
                   {"mean_error_voxels", lod.certificate.meanErrorVoxels},
                   {"max_error_metres", lod.certificate.maxErrorVoxels * metres},
                   {"mean_error_metres", lod.certificate.meanErrorVoxels * metres}};
    if (!lod.dropped.empty()) extras["dropped_components"] = lod.dropped.size();
    if (streams.frame.quantized) {
      // Half a step along each axis.
      extras["quantization_error_metres"] =
          std::sqrt(3.0) * 0.5 * options_.scale / streams.frame.factor;
    }
    return extras;
  }

  void finish() {
    if (levels_.empty()) return;
    json_["scenes"] = Json::array({{{"nodes", {0}}}});
    if (options_.compression != LodCompression::None) require("KHR_mesh_quantization");
    if (packs()) require("EXT_meshopt_compression");
    if (levels_.size() > 1) linkLevels();
    json_["buffers"] = Json::array({{{"byteLength", binaryBytes_}}});
    if (packs()) {
      json_["buffers"].push_back(
          {{"byteLength", plainBytes_},
           {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}});
    }
  }

  /// Programs that know MSFT_lod find the other LODs by it; those that do not show the first one
  /// alone; those that go by names find all in a scene of their own, if there is to be one.
  void linkLevels() {
    json_["extensionsUsed"].push_back("MSFT_lod");
    Json all = Json::array(), others = Json::array(), coverage = Json::array();
    for (std::size_t i = 0; i < levels_.size(); ++i) {
      all.push_back(i);
      if (i > 0) others.push_back(i);
      coverage.push_back(chain_.levels[levels_[i]].screenCoverage);
    }
    Json& first = json_["nodes"][0];
    first["extensions"]["MSFT_lod"]["ids"] = others;
    first["extras"]["MSFT_screencoverage"] = coverage;
    if (!options_.allLevelsScene) return;
    json_["scenes"].push_back({{"name", options_.name + "_all_levels"}, {"nodes", all}});
  }

  void require(const char* extension) {
    json_["extensionsUsed"].push_back(extension);
    json_["extensionsRequired"].push_back(extension);
  }

  const LodChain& chain_;
  const LodWriteOptions& options_;
  Json json_ = glb::emptyDocument();
  std::vector<std::size_t> levels_;  ///< of the nodes
  std::vector<std::string> blobs_;
  std::uint64_t binaryBytes_ = 0;
  std::uint64_t plainBytes_ = 0;  ///< of the buffer that packed views stand for
};

constexpr std::string_view kBraces = "{}";

bool namesMany(const std::filesystem::path& path) {
  return path.filename().string().find(kBraces) != std::string::npos;
}

class LodWriter {
 public:
  LodWriter(const LodChain& chain, const LodWriteOptions& options, LodWriteReport& report)
      : chain_(chain),
        options_(options),
        report_(report),
        frames_(framesFor(chain, options)),
        job_(options.threads, options.progress) {}

  void writeOne(const std::filesystem::path& path) {
    const MeshFormat format = meshFormatOf(path);
    requireLevels(format, path.string());
    OutputFile file(path);
    writeAll(file, format);
    report_.files.push_back(path);
  }

  void writeOne(std::ostream& stream, MeshFormat format) {
    requireLevels(format, "the stream");
    OutputFile file(stream);
    writeAll(file, format);
  }

  void writeMany(const std::filesystem::path& path) {
    job_.run([&] {
      for (std::size_t level = 0; level < chain_.levels.size(); ++level) {
        writeLevel(lodFile(path, level), level);
      }
    });
    job_.finish();
  }

 private:
  static void requireLevels(MeshFormat format, const std::string& target) {
    if (format == MeshFormat::Glb || format == MeshFormat::Usda) return;
    throw Error(ErrorCode::InvalidArgument,
                target +
                    ": only .glb and .usda hold several levels; write {} in the file name for one "
                    "file a level");
  }

  /// The share of the work that some LODs are, by their triangles.
  [[nodiscard]] double shareUpTo(std::size_t levels) const {
    double done = 0, all = 1;
    for (std::size_t i = 0; i < chain_.levels.size(); ++i) {
      const auto count = static_cast<double>(chain_.levels[i].mesh.triangleCount());
      all += count;
      if (i < levels) done += count;
    }
    return done / all;
  }

  void writeAll(OutputFile& file, MeshFormat format) {
    if (format == MeshFormat::Usda) {
      writeVariants(file);
      return;
    }
    job_.run([&] {
      LodDocument document(chain_, options_);
      for (std::size_t level = 0; level < chain_.levels.size(); ++level) {
        addLevel(document, level);
      }
      finish(document, file, 1);
    });
    job_.finish();
  }

  void writeVariants(OutputFile& file) {
    std::vector<MeshPart> parts;
    job_.run([&] {
      for (std::size_t level = 0; level < chain_.levels.size(); ++level) {
        const Mesh& mesh = chain_.levels[level].mesh;
        requireSoundAttributes(mesh);
        job_.beginStage("encoding", 0.5 * shareUpTo(level + 1));
        parts.push_back({&mesh, options_.name, {}});
        if (options_.creaseAngle < 180 && !mesh.normals.empty()) {
          parts.back().shaded = splitAtCreases(mesh, options_.creaseAngle, job_);
        }
        report_.vertices.push_back(mesh.positions.size());
      }
      job_.beginStage("writing", 1);
      const Progress nobody;
      MeshSink sink(file, 0, 0, nobody);
      writeUsdaLods(parts, {options_.name, options_.up, options_.scale}, sink);
      file.commit();
    });
    job_.finish();
  }

  void addLevel(LodDocument& document, std::size_t level) {
    const Mesh& mesh = chain_.levels[level].mesh;
    job_.beginStage("encoding", shareUpTo(level + 1));
    requireSoundAttributes(mesh);
    if (mesh.triangleCount() == 0) return;
    ShadedMesh shaded = splitAtCreases(mesh, options_.creaseAngle, job_);
    orderForGraphics(shaded);
    LodStreams streams = encodeLevel(mesh, shaded, frames_, options_);
    report_.vertices.push_back(shaded.sources.size());
    if (options_.compression != LodCompression::None && !streams.frame.quantized) {
      report_.floatLevels.push_back(level);
    }
    document.addLevel(level, std::move(streams));
  }

  void finish(LodDocument& document, OutputFile& file, double end) {
    job_.beginStage("writing", end);
    document.write(file);
    file.commit();
  }

  void writeLevel(const std::filesystem::path& path, std::size_t level) {
    const double end = shareUpTo(level + 1);
    if (meshFormatOf(path) == MeshFormat::Glb) {
      OutputFile file(path);
      LodDocument document(chain_, options_);
      addLevel(document, level);
      finish(document, file, end);
      report_.files.push_back(path);
      return;
    }
    job_.beginStage("writing", end);
    const Mesh& mesh = chain_.levels[level].mesh;
    WriteOptions options;
    options.name = options_.name + "_LOD" + std::to_string(level);
    options.creaseAngle = options_.creaseAngle;
    options.up = options_.up;
    options.scale = options_.scale;
    options.threads = options_.threads;
    tufa::write(mesh, path, options);
    report_.vertices.push_back(mesh.positions.size());
    report_.files.push_back(path);
  }

  const LodChain& chain_;
  const LodWriteOptions& options_;
  LodWriteReport& report_;
  std::vector<LodFrame> frames_;
  base::Job job_;
};

template <class Work>
void runWriter(const LodChain& chain, const LodWriteOptions& options, LodWriteReport* report,
               Work&& work) {
  requireInRange(options);
  LodWriteReport found;
  base::runIsolated([&] {
    LodWriter writer(chain, options, found);
    work(writer);
  });
  if (report != nullptr) *report = std::move(found);
}

}  // namespace
}  // namespace io

std::filesystem::path lodFile(const std::filesystem::path& path, std::size_t level) {
  std::string name = path.filename().string();
  const std::size_t braces = name.find(io::kBraces);
  if (braces == std::string::npos) return path;
  name.replace(braces, io::kBraces.size(), std::to_string(level));
  return path.parent_path() / name;
}

void writeLods(const LodChain& chain, const std::filesystem::path& path,
               const LodWriteOptions& options, LodWriteReport* report) {
  io::runWriter(chain, options, report, [&](io::LodWriter& writer) {
    if (io::namesMany(path)) {
      writer.writeMany(path);
    } else {
      writer.writeOne(path);
    }
  });
}

void writeLods(const LodChain& chain, std::ostream& stream, MeshFormat format,
               const LodWriteOptions& options, LodWriteReport* report) {
  io::runWriter(chain, options, report,
                [&](io::LodWriter& writer) { writer.writeOne(stream, format); });
}

}  // namespace tufa
