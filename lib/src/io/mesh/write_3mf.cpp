// .3mf, through lib3mf: an object and a build item for each mesh.

#include <Model/COM/NMR_DLLInterfaces.h>

#include <tufa/error.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "base/checksum.h"
#include "base/parallel_sort.h"
#include "base/printable.h"
#include "base/require_at_most.h"
#include "io/mesh/mesh_format.h"

namespace tufa::io {
namespace {

/// lib3mf writes so many parts of a unit, and no smaller ones.
constexpr double kParts = 1e6;
/// Below this many metres a world unit is stored in micrometres: else voxels would be near to a
/// part.
constexpr double kSmallUnit = 1e-5;
constexpr double kMillimetres = 1e3;
constexpr double kMicrometres = 1e6;
/// lib3mf takes no coordinates beyond.
constexpr double kFarthest = 1e9;

/// Throws for what lib3mf refuses. The codes are those of its NMR_ErrorConst.h.
void require(LIB3MFRESULT result, const char* what) {
  if (result == 0) return;
  throw Error(ErrorCode::UnwritableFile, std::string("lib3mf cannot ") + what + ": error " +
                                             std::to_string(static_cast<std::uint32_t>(result)));
}

struct Release {
  void operator()(NMR::PLib3MFBase* object) const { NMR::lib3mf_release(object); }
};
/// One of lib3mf's objects.
template <class Object>
using Owned = std::unique_ptr<Object, Release>;

/// A file in memory that lib3mf writes to.
struct Sink {
  std::string bytes;
  std::size_t place = 0;
};

DWORD writeBytes(const BYTE* data, DWORD size, void* target) {
  Sink& sink = *static_cast<Sink*>(target);
  if (sink.place + size > sink.bytes.size()) sink.bytes.resize(sink.place + size);
  std::memcpy(sink.bytes.data() + sink.place, data, size);
  sink.place += size;
  return 0;
}

DWORD seekTo(ULONG64 place, void* target) {
  static_cast<Sink*>(target)->place = static_cast<std::size_t>(place);
  return 0;
}

/// An identifier that follows from what the file holds: lib3mf would take a random one.
std::string identifier(const std::string& checksum, std::size_t number) {
  constexpr std::size_t kDigits = 12;
  std::string last = std::to_string(number);
  last.insert(0, kDigits - std::min(kDigits, last.size()), '0');
  return checksum.substr(0, 8) + "-" + checksum.substr(8, 4) + "-8" + checksum.substr(12, 3) +
         "-800" + checksum.substr(15, 1) + "-" + last;
}

/// A mesh as lib3mf takes it.
struct Geometry {
  std::vector<NMR::MODELMESHVERTEX> vertices;
  std::vector<NMR::MODELMESHTRIANGLE> triangles;
};

/// Throws Error(LimitExceeded) where positions that differ would be the same in the file.
void requireApart(const std::vector<NMR::MODELMESHVERTEX>& vertices, const Mesh& mesh) {
  using Place = std::array<std::int64_t, 3>;
  std::vector<std::pair<Place, std::size_t>> places;
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    Place place{};
    for (std::size_t i = 0; i < 3; ++i) {
      place[i] = static_cast<std::int64_t>(kParts * vertices[v].m_fPosition[i]);
    }
    places.emplace_back(place, v);
  }
  base::parallelSort(places.begin(), places.end(),
                     [](const auto& a, const auto& b) { return a < b; });
  const auto same =
      std::adjacent_find(places.begin(), places.end(), [&](const auto& a, const auto& b) {
        return a.first == b.first && !(mesh.positions[a.second] == mesh.positions[b.second]);
      });
  if (same == places.end()) return;
  throw Error(ErrorCode::LimitExceeded,
              "vertices are nearer to each other than .3mf tells apart; write .ply, or give the "
              "length of a world unit in metres, the scale");
}

Geometry geometryOf(const Mesh& mesh, const FileFrame& frame, double factor) {
  constexpr std::size_t kMost = std::numeric_limits<std::int32_t>::max();
  base::requireAtMost(kMost - 1, mesh.positions.size(), "vertices", ".3mf");
  base::requireAtMost(kMost - 1, mesh.triangleCount(), "triangles", ".3mf");
  Geometry geometry;
  geometry.vertices.reserve(mesh.positions.size());
  for (const Position& p : mesh.positions) {
    // In .3mf z points up.
    const std::array<double, 3> upright = frame.up == UpAxis::Z
                                              ? std::array<double, 3>{p.x, p.y, p.z}
                                              : std::array<double, 3>{p.x, -p.z, p.y};
    NMR::MODELMESHVERTEX vertex{};
    for (std::size_t i = 0; i < 3; ++i) {
      const double place = factor * upright[i];
      if (!(std::abs(place) < kFarthest)) {
        throw Error(ErrorCode::LimitExceeded, "a vertex lies too far away for .3mf: " +
                                                  std::to_string(upright[i]) + " world units");
      }
      vertex.m_fPosition[i] = static_cast<float>(place) + 0.0F;
    }
    geometry.vertices.push_back(vertex);
  }
  requireApart(geometry.vertices, mesh);
  for (const Triangle& t : triangulate(mesh)) {
    geometry.triangles.push_back({{t.vertices[0], t.vertices[1], t.vertices[2]}});
  }
  return geometry;
}

template <class Element>
std::string_view bytesOf(const std::vector<Element>& elements) {
  return {reinterpret_cast<const char*>(elements.data()), elements.size() * sizeof(Element)};
}

/// A model while meshes are added to it.
class Model {
 public:
  explicit Model(NMR::eModelUnit unit) {
    NMR::PLib3MFModel* model = nullptr;
    require(NMR::lib3mf_createmodel(&model), "make a model");
    model_.reset(model);
    require(NMR::lib3mf_model_setunit(model, unit), "set the unit");
    require(NMR::lib3mf_model_addmetadatautf8(model, "Application", "tufa"), "name the program");
  }

  void add(const std::string& name, Geometry geometry) {
    base::Checksum checksum;
    checksum.add(bytesOf(geometry.vertices));
    checksum.add(bytesOf(geometry.triangles));
    all_.add(checksum.text());
    NMR::PLib3MFModelMeshObject* object = nullptr;
    require(NMR::lib3mf_model_addmeshobject(model_.get(), &object), "add a mesh");
    const Owned<NMR::PLib3MFModelMeshObject> owned(object);
    require(NMR::lib3mf_object_setnameutf8(object, base::printable(name).c_str()), "name a mesh");
    require(NMR::lib3mf_meshobject_setgeometry(
                object, geometry.vertices.data(), static_cast<DWORD>(geometry.vertices.size()),
                geometry.triangles.data(), static_cast<DWORD>(geometry.triangles.size())),
            "take a mesh");
    identify(checksum.text(),
             [&](const char* id) { return NMR::lib3mf_object_setuuidutf8(object, id); });
    NMR::PLib3MFModelBuildItem* item = nullptr;
    require(NMR::lib3mf_model_addbuilditem(model_.get(), object, nullptr, &item), "add an item");
    const Owned<NMR::PLib3MFModelBuildItem> ownedItem(item);
    identify(checksum.text(),
             [&](const char* id) { return NMR::lib3mf_builditem_setuuidutf8(item, id); });
  }

  [[nodiscard]] std::string bytes() {
    identify(all_.text(),
             [&](const char* id) { return NMR::lib3mf_model_setbuilduuidutf8(model_.get(), id); });
    NMR::PLib3MFModelWriter* writer = nullptr;
    require(NMR::lib3mf_model_querywriter(model_.get(), MODELWRITERCLASS_3MF, &writer),
            "make a writer");
    const Owned<NMR::PLib3MFModelWriter> owned(writer);
    Sink sink;
    require(NMR::lib3mf_writer_writetocallback(writer, reinterpret_cast<void*>(writeBytes),
                                               reinterpret_cast<void*>(seekTo), &sink),
            "write the model");
    return std::move(sink.bytes);
  }

 private:
  template <class Set>
  void identify(const std::string& checksum, const Set& set) {
    require(set(identifier(checksum, ++identifiers_).c_str()), "identify a part");
  }

  Owned<NMR::PLib3MFModel> model_;
  base::Checksum all_;
  std::size_t identifiers_ = 0;
};

}  // namespace

bool has3mf() { return true; }

void write3mf(std::span<const MeshPart> parts, const FileFrame& frame, MeshSink& sink) {
  const bool small = frame.scale < kSmallUnit;
  Model model(small ? NMR::MODELUNIT_MICROMETER : NMR::MODELUNIT_MILLIMETER);
  for (const MeshPart& part : parts) {
    const Mesh& mesh = *part.mesh;
    if (mesh.triangleCount() == 0) continue;
    model.add(part.name,
              geometryOf(mesh, frame, frame.scale * (small ? kMicrometres : kMillimetres)));
    sink.advance(mesh.positions.size() + mesh.triangleCount());
  }
  const std::string bytes = model.bytes();
  sink.write(bytes.data(), bytes.size());
}

}  // namespace tufa::io
