#include <tufa/error.h>
#include <tufa/io.h>
#include <tufa/lod.h>
#include <tufa/memory.h>
#include <algorithm>
#include <cmath>

#include "base/braces.h"
#include "base/job.h"
#include "base/known_enum.h"
#include "base/require_mesh.h"
#include "io/gltf/glb.h"
#include "io/gltf/glb_document.h"
#include "io/mesh/file_attributes.h"
#include "io/mesh/float_precision.h"
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
  base::requireKnown(options.compression, GlbCompression::Meshopt, "the compression");
}

GlbPacking packingOf(const LodWriteOptions& options) {
  return {options.compression, options.up, options.scale};
}

std::vector<const Mesh*> meshesOf(const LodChain& chain) {
  std::vector<const Mesh*> meshes;
  for (const Lod& lod : chain.levels) meshes.push_back(&lod.mesh);
  return meshes;
}

/// Builds a .glb of some LODs.
class LodDocument {
 public:
  LodDocument(const LodChain& chain, const LodWriteOptions& options)
      : chain_(chain), options_(options), document_(options.compression) {}

  void addLevel(std::size_t level, GlbStreams streams) {
    const Json extras = extrasOf(level, streams);
    const std::vector<Attribute>& attributes = chain_.levels[level].mesh.attributes;
    const Json vertices = document_.addVertices(streams, attributes);
    const std::size_t whole[] = {streams.indices.count};
    document_.addMesh({options_.name + "_LOD" + std::to_string(level),
                       document_.addParts(vertices, streams.indices, whole), attributes},
                      streams.frame, extras);
    levels_.push_back(level);
  }

  void write(OutputFile& file) {
    if (!levels_.empty()) document_.json()["scenes"] = Json::array({{{"nodes", {0}}}});
    if (levels_.size() > 1) linkLevels();
    document_.write([&](std::string_view bytes) { file.write(bytes.data(), bytes.size()); });
  }

 private:
  [[nodiscard]] Json extrasOf(std::size_t level, const GlbStreams& streams) const {
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

  /// Programs that know MSFT_lod find the other LODs by it; those that do not show the first one
  /// alone; those that go by names find all in a scene of their own, if there is to be one.
  void linkLevels() {
    Json& json = document_.json();
    json["extensionsUsed"].push_back("MSFT_lod");
    Json all = Json::array(), others = Json::array(), coverage = Json::array();
    for (std::size_t i = 0; i < levels_.size(); ++i) {
      all.push_back(i);
      if (i > 0) others.push_back(i);
      coverage.push_back(chain_.levels[levels_[i]].screenCoverage);
    }
    Json& first = json["nodes"][0];
    first["extensions"]["MSFT_lod"]["ids"] = others;
    first["extras"]["MSFT_screencoverage"] = coverage;
    if (!options_.allLevelsScene) return;
    json["scenes"].push_back({{"name", options_.name + "_all_levels"}, {"nodes", all}});
  }

  const LodChain& chain_;
  const LodWriteOptions& options_;
  GlbDocument document_;
  std::vector<std::size_t> levels_;  ///< of the nodes
};

class LodWriter {
 public:
  LodWriter(const LodChain& chain, const LodWriteOptions& options, LodWriteReport& report)
      : chain_(chain),
        options_(options),
        report_(report),
        packing_(packingOf(options)),
        frames_(framesFor(meshesOf(chain), packing_)),
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
    if (chain_.levels.empty()) return writeNothing(lodFile(path, 0));
    job_.run([&] {
      for (std::size_t level = 0; level < chain_.levels.size(); ++level) {
        writeLevel(lodFile(path, level), level);
      }
    });
    job_.finish();
  }

 private:
  // An empty mesh where a surface has no LODs.
  void writeNothing(const std::filesystem::path& path) {
    WriteOptions options;
    options.name = options_.name + "_LOD0";
    options.progress = options_.progress;
    tufa::write(Mesh(), path, options);
    report_.files.push_back(path);
  }

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
        requireFloatRange(mesh);
        seeRounding(requireFloatsEnough(mesh, floatOrigin(mesh), ".usda"));
        requireSoundAttributes(mesh.attributes, mesh.positions.size(), false);
        job_.beginStage("encoding", 0.5 * shareUpTo(level + 1));
        parts.push_back({&mesh, options_.name, {}});
        if (options_.creaseAngle < 180 && !mesh.normals.empty()) {
          parts.back().shaded = shading::splitAtCreases(mesh, options_.creaseAngle, job_);
        }
        report_.vertices.push_back(mesh.positions.size());
      }
      job_.beginStage("writing", 1);
      std::size_t total = 0;
      for (const MeshPart& part : parts) total += usdaItems(part);
      const Progress progress = writingProgress();
      MeshSink sink(file, total, 0, progress);
      writeUsdaLods(parts, {options_.name, options_.up, options_.scale}, sink);
      sink.finish();
      file.commit();
    });
    job_.finish();
  }

  /// The progress of what writes meshes by itself, as that of the present stage.
  [[nodiscard]] Progress writingProgress() {
    return [this](std::string_view /*stage*/, double fraction) {
      constexpr double kSteps = 1000;
      job_.checkCancelled(static_cast<std::size_t>(kSteps * std::clamp(fraction, 0.0, 1.0)),
                          static_cast<std::size_t>(kSteps));
      return true;
    };
  }

  void addLevel(LodDocument& document, std::size_t level) {
    const Mesh& mesh = chain_.levels[level].mesh;
    job_.beginStage("encoding", shareUpTo(level + 1));
    requireFloatRange(mesh);
    requireSoundAttributes(mesh.attributes, mesh.positions.size(), true);
    if (mesh.triangleCount() == 0) {
      report_.vertices.push_back(0);
      return;
    }
    ShadedMesh shaded = shading::splitAtCreases(mesh, options_.creaseAngle, job_);
    const std::size_t whole[] = {shaded.indices.size()};
    shading::orderForGraphics(shaded, whole);
    GlbStreams streams =
        encode(mesh, shaded, frames_, packing_, [&] { job_.checkCancelled(0, 1); });
    report_.vertices.push_back(shaded.sources.size());
    if (!streams.frame.quantized) {
      if (options_.compression != GlbCompression::None) report_.floatLevels.push_back(level);
      seeRounding(requireFloatsEnough(mesh, originOf(streams.frame, options_.up), ".glb"));
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
    options.progress = writingProgress();
    WriteReport written;
    tufa::write(mesh, path, options, &written);
    seeRounding(written.rounding);
    report_.vertices.push_back(mesh.positions.size());
    report_.files.push_back(path);
  }

  void seeRounding(double rounding) { report_.rounding = std::max(report_.rounding, rounding); }

  const LodChain& chain_;
  const LodWriteOptions& options_;
  LodWriteReport& report_;
  GlbPacking packing_;
  std::vector<GlbFrame> frames_;
  base::Job job_;
};

template <class Work>
void runWriter(const LodChain& chain, const LodWriteOptions& options, LodWriteReport* report,
               Work&& work) {
  requireInRange(options);
  for (const Lod& lod : chain.levels) {
    base::requireFaces(lod.mesh);
    base::requireFinite(lod.mesh);
    base::requireNormals(lod.mesh);
  }
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
  return base::fillBraces(path, std::to_string(level));
}

void writeLods(const LodChain& chain, const std::filesystem::path& path,
               const LodWriteOptions& options, LodWriteReport* report) {
  io::runWriter(chain, options, report, [&](io::LodWriter& writer) {
    if (base::hasBraces(path)) {
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
