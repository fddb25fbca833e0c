#include "io/gltf/glb_streams.h"

#include <meshoptimizer.h>

#include <tufa/error.h>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include "base/parallel_sort.h"
#include "io/gltf/glb.h"
#include "io/mesh/file_attributes.h"
#include "io/mesh/float_precision.h"
#include "io/mesh/mesh_format.h"

namespace tufa::io {
namespace {

using Point = std::array<double, 3>;
using glb::Floats;
using shading::ShadedMesh;

constexpr double kMostByte = 127;

/// The elements of all positions of a mesh. Numbers of 16 bits are exact in floats.
std::vector<Floats> elementsOf(const Mesh& mesh, const GlbFrame& frame, UpAxis up) {
  std::vector<Floats> elements(mesh.positions.size());
  for (std::size_t v = 0; v < elements.size(); ++v) {
    const Position& p = mesh.positions[v];
    const Point place = turned({p.x, p.y, p.z}, up);
    for (std::size_t i = 0; i < 3; ++i) {
      double element = frame.factor * (place[i] - frame.origin[i]);
      if (frame.quantized) element = std::clamp(std::round(element), 0.0, kMostShort);
      // Without + 0 there would be -0 too, and different bytes for equal positions.
      elements[v][i] = static_cast<float>(element) + 0.0F;
    }
  }
  return elements;
}

/// Whether different positions have different elements.
bool tellsApart(const Mesh& mesh, const std::vector<Floats>& elements) {
  std::vector<VertexIndex> order(elements.size());
  for (std::size_t v = 0; v < order.size(); ++v) order[v] = static_cast<VertexIndex>(v);
  base::parallelSort(order.begin(), order.end(), [&](VertexIndex a, VertexIndex b) {
    return elements[a] != elements[b] ? elements[a] < elements[b] : a < b;
  });
  return std::adjacent_find(order.begin(), order.end(), [&](VertexIndex a, VertexIndex b) {
           return elements[a] == elements[b] && !(mesh.positions[a] == mesh.positions[b]);
         }) == order.end();
}

/// Whether three points span no area; exact for numbers of 16 bits.
bool onALine(const Point& a, const Point& b, const Point& c) {
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    if ((b[i] - a[i]) * (c[j] - a[j]) != (b[j] - a[j]) * (c[i] - a[i])) return false;
  }
  return true;
}

/// Whether every triangle that has an area keeps one.
bool keepsAreas(const Mesh& mesh, const ShadedMesh& shaded, const std::vector<Floats>& elements) {
  const auto element = [&](VertexIndex n) {
    const Floats& e = elements[shaded.sources[n]];
    return Point{e[0], e[1], e[2]};
  };
  const auto position = [&](VertexIndex n) {
    const Position& p = mesh.positions[shaded.sources[n]];
    return Point{p.x, p.y, p.z};
  };
  for (std::size_t i = 0; i < shaded.indices.size(); i += 3) {
    const VertexIndex* const t = &shaded.indices[i];
    if (onALine(element(t[0]), element(t[1]), element(t[2])) &&
        !onALine(position(t[0]), position(t[1]), position(t[2]))) {
      return false;
    }
  }
  return true;
}

template <class Number>
void append(std::string& bytes, Number number) {
  std::array<char, sizeof number> raw;
  std::memcpy(raw.data(), &number, sizeof number);
  bytes.append(raw.data(), raw.size());
}

GlbStream positionStream(const std::vector<Floats>& elements, const ShadedMesh& shaded,
                         const GlbFrame& frame) {
  const bool quantized = frame.quantized;
  // Rows of 16 bit numbers start at multiples of 4 bytes, so one of four is unused.
  GlbStream stream{{},
                   quantized ? 8U : 12U,
                   shaded.sources.size(),
                   quantized ? glb::kUnsignedShort : glb::kFloat,
                   "VEC3",
                   frame.normalized};
  stream.bytes.reserve(stream.stride * stream.count);
  for (const VertexIndex source : shaded.sources) {
    for (const float number : elements[source]) {
      if (quantized) {
        append(stream.bytes, static_cast<std::uint16_t>(number));
      } else {
        append(stream.bytes, number);
      }
    }
    if (quantized) append(stream.bytes, std::uint16_t{0});
  }
  return stream;
}

/// The 8-bit vector nearest in direction to a unit vector among those of about its length: rounding
/// each component by itself may give one shorter than glTF allows.
std::array<std::int8_t, 3> roundNormal(const Floats& unit) {
  // What the Khronos validator takes for unit length, less some.
  constexpr double kMostStretch = 0.006;
  std::array<std::int8_t, 3> best{0, 0, 127};
  double bestCosine = -2;
  for (unsigned choice = 0; choice < 8; ++choice) {
    std::array<double, 3> rounded;
    double squared = 0, dot = 0;
    for (unsigned i = 0; i < 3; ++i) {
      const double exact = double{unit[i]} * kMostByte;
      rounded[i] = (choice >> i & 1U) != 0 ? std::ceil(exact) : std::floor(exact);
      rounded[i] = std::clamp(rounded[i], -kMostByte, kMostByte);
      squared += rounded[i] * rounded[i];
      dot += rounded[i] * exact;
    }
    const double length = std::sqrt(squared);
    if (std::abs(length / kMostByte - 1) > kMostStretch) continue;
    const double cosine = dot / (length * kMostByte);
    if (cosine <= bestCosine) continue;
    bestCosine = cosine;
    for (unsigned i = 0; i < 3; ++i) best[i] = static_cast<std::int8_t>(rounded[i]);
  }
  return best;
}

GlbStream normalStream(const ShadedMesh& shaded, UpAxis up, bool quantized) {
  GlbStream stream{{},
                   quantized ? 4U : 12U,
                   shaded.normals.size(),
                   quantized ? glb::kByte : glb::kFloat,
                   "VEC3",
                   quantized};
  stream.bytes.reserve(stream.stride * stream.count);
  for (const Normal& normal : shaded.normals) {
    const Floats unit = glb::unitNormal(normal);
    const Point n = turned({unit[0], unit[1], unit[2]}, up);
    const Floats upright = {static_cast<float>(n[0]), static_cast<float>(n[1]),
                            static_cast<float>(n[2])};
    if (quantized) {
      for (const std::int8_t number : roundNormal(upright)) append(stream.bytes, number);
      append(stream.bytes, std::int8_t{0});
    } else {
      for (const float number : upright) append(stream.bytes, number);
    }
  }
  return stream;
}

/// Attributes are floats in any case: what range they need is not known.
GlbStream attributeStream(const Attribute& attribute, const ShadedMesh& shaded) {
  const auto width = static_cast<std::size_t>(attribute.width);
  GlbStream stream{
      {}, width * sizeof(float), shaded.sources.size(), glb::kFloat, gltfType(attribute)};
  stream.bytes.reserve(stream.stride * stream.count);
  for (const VertexIndex source : shaded.sources) {
    for (std::size_t i = source * width; i < (source + 1) * width; ++i) {
      append(stream.bytes, gltfValue(attribute, i));
    }
  }
  return stream;
}

GlbStream indexStream(const ShadedMesh& shaded) {
  const bool isShort = shaded.sources.size() <= glb::kMostShortVertices;
  GlbStream stream{{},
                   isShort ? 2U : 4U,
                   shaded.indices.size(),
                   isShort ? glb::kUnsignedShort : glb::kUnsignedInt,
                   "SCALAR"};
  stream.bytes.reserve(stream.stride * stream.count);
  for (const VertexIndex index : shaded.indices) {
    if (isShort) {
      append(stream.bytes, static_cast<std::uint16_t>(index));
    } else {
      append(stream.bytes, index);
    }
  }
  return stream;
}

/// Makes the library use the versions of its codecs that the extension specifies, whatever its
/// defaults.
void setCodecVersions() {
  static const bool set = [] {
    meshopt_encodeVertexVersion(0);
    meshopt_encodeIndexVersion(1);
    return true;
  }();
  static_cast<void>(set);
}

/// Packs a stream of vertices as EXT_meshopt_compression's mode ATTRIBUTES has it.
void packVertices(GlbStream& stream) {
  std::string packed(meshopt_encodeVertexBufferBound(stream.count, stream.stride), '\0');
  auto* const bytes = reinterpret_cast<unsigned char*>(packed.data());
  setCodecVersions();
  packed.resize(meshopt_encodeVertexBuffer(bytes, packed.size(), stream.bytes.data(), stream.count,
                                           stream.stride));
  stream.bytes = std::move(packed);
}

/// Packs triangles in its mode TRIANGLES, which may rotate the corners of a triangle.
void packTriangles(const ShadedMesh& shaded, GlbStream& stream) {
  std::string packed(meshopt_encodeIndexBufferBound(shaded.indices.size(), shaded.sources.size()),
                     '\0');
  setCodecVersions();
  packed.resize(meshopt_encodeIndexBuffer(reinterpret_cast<unsigned char*>(packed.data()),
                                          packed.size(), shaded.indices.data(),
                                          shaded.indices.size()));
  stream.bytes = std::move(packed);
}

struct Extent {
  Point least;
  Point greatest;
};

Extent extentOf(std::span<const Mesh* const> meshes, UpAxis up) {
  const double infinity = std::numeric_limits<double>::infinity();
  Extent extent{{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
  for (const Mesh* const mesh : meshes) {
    for (const Position& p : mesh->positions) {
      const Point place = turned({p.x, p.y, p.z}, up);
      for (std::size_t i = 0; i < 3; ++i) {
        extent.least[i] = std::min(extent.least[i], place[i]);
        extent.greatest[i] = std::max(extent.greatest[i], place[i]);
      }
    }
  }
  return extent;
}

GlbFrame frameAt(const Point& origin, double factor, double nodeScale, double scale) {
  GlbFrame frame{origin, factor, nodeScale, {}, false, false};
  for (std::size_t i = 0; i < 3; ++i) frame.translation[i] = scale * origin[i];
  return frame;
}

using Range = std::array<Floats, 2>;

/// Widens a range, of nothing at first, by an element.
void widen(std::optional<Range>& range, const Floats& element) {
  if (!range) range = Range{element, element};
  for (std::size_t i = 0; i < 3; ++i) {
    range->front()[i] = std::min(range->front()[i], element[i]);
    range->back()[i] = std::max(range->back()[i], element[i]);
  }
}

/// How far elements move: floats, in the unit that the elements of the frame stand for.
GlbStream motionStream(const Attribute& attribute, const ShadedMesh& shaded, const GlbFrame& frame,
                       UpAxis up) {
  GlbStream stream{{}, sizeof(Floats), shaded.sources.size(), glb::kFloat, "VEC3"};
  stream.bytes.reserve(stream.stride * stream.count);
  const double factor = frame.factor / (frame.normalized ? kMostShort : 1);
  for (const VertexIndex source : shaded.sources) {
    const float* const value = attribute.values.data() + 3 * std::size_t{source};
    const Point way = turned({value[0], value[1], value[2]}, up);
    Floats element{};
    for (std::size_t i = 0; i < 3; ++i) {
      element[i] = static_cast<float>(factor * way[i]) + 0.0F;
      append(stream.bytes, element[i]);
    }
    widen(stream.range, element);
  }
  return stream;
}

GlbStreams encodeElements(const GlbFrame& frame, const std::vector<Floats>& elements,
                          const Mesh& mesh, const ShadedMesh& shaded, const GlbPacking& packing,
                          const std::function<void()>& check) {
  GlbStreams streams;
  streams.frame = frame;
  streams.positions = positionStream(elements, shaded, frame);
  for (const VertexIndex source : shaded.sources) widen(streams.positions.range, elements[source]);
  if (!shaded.normals.empty()) {
    streams.normals = normalStream(shaded, packing.up, packing.compression != GlbCompression::None);
  }
  for (const Attribute& attribute : mesh.attributes) {
    streams.attributes.push_back(attribute.role == AttributeRole::Motion
                                     ? motionStream(attribute, shaded, frame, packing.up)
                                     : attributeStream(attribute, shaded));
  }
  streams.indices = indexStream(shaded);
  if (packing.compression != GlbCompression::Meshopt) return streams;
  const auto pack = [&](GlbStream& stream) {
    check();
    packVertices(stream);
  };
  pack(streams.positions);
  if (!shaded.normals.empty()) pack(streams.normals);
  for (GlbStream& attribute : streams.attributes) pack(attribute);
  check();
  packTriangles(shaded, streams.indices);
  return streams;
}

}  // namespace

Point turned(const Point& p, UpAxis up) { return up == UpAxis::Y ? p : Point{p[0], p[2], -p[1]}; }

Point turnedBack(const Point& p, UpAxis up) {
  return up == UpAxis::Y ? p : Point{p[0], -p[2], p[1]};
}

Position originOf(const GlbFrame& frame, UpAxis up) {
  const Point p = turnedBack(frame.origin, up);
  return {p[0], p[1], p[2]};
}

GlbFrame floatFrame(const Point& origin, double factor, const GlbPacking& packing) {
  return frameAt(origin, factor, packing.scale / factor, packing.scale);
}

std::vector<GlbFrame> framesFor(std::span<const Mesh* const> meshes, const GlbPacking& packing) {
  const Extent extent = extentOf(meshes, packing.up);
  std::vector<GlbFrame> frames;
  double size = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    size = std::max(size, extent.greatest[i] - extent.least[i]);
  }
  if (packing.compression != GlbCompression::None && size > 0) {
    frames.push_back(frameAt(extent.least, kMostShort / size, size * packing.scale, packing.scale));
    frames.back().quantized = frames.back().normalized = true;
  }
  Point origin{0, 0, 0};
  if (std::any_of(meshes.begin(), meshes.end(),
                  [](const Mesh* mesh) { return needsDoublePrecision(*mesh); })) {
    for (std::size_t i = 0; i < 3; ++i) {
      origin[i] = static_cast<float>(0.5 * (extent.least[i] + extent.greatest[i]));
    }
  }
  frames.push_back(floatFrame(origin, packing.scale, packing));
  // In metres two vertices may round to one. In world units they keep their values.
  if (packing.scale != 1) frames.push_back(floatFrame(origin, 1, packing));
  return frames;
}

GlbStreams encode(const Mesh& mesh, const ShadedMesh& shaded, std::span<const GlbFrame> frames,
                  const GlbPacking& packing, const std::function<void()>& check) {
  for (const GlbFrame& frame : frames) {
    check();
    const std::vector<Floats> elements = elementsOf(mesh, frame, packing.up);
    if (!tellsApart(mesh, elements)) continue;
    if (frame.quantized && !keepsAreas(mesh, shaded, elements)) continue;
    return encodeElements(frame, elements, mesh, shaded, packing, check);
  }
  throw Error(ErrorCode::LimitExceeded,
              "vertices are nearer to each other than the single precision of .glb tells apart; "
              "write .ply, which has double precision");
}

GlbStreams encodeIn(const GlbFrame& frame, const Mesh& mesh, const ShadedMesh& shaded,
                    const GlbPacking& packing) {
  return encodeElements(frame, elementsOf(mesh, frame, packing.up), mesh, shaded, packing, [] {});
}

}  // namespace tufa::io
