// .glb: triangles of all meshes of the scene, through the transforms of their nodes. Of levels of
// detail the finest, which alone stands in the scene.

#include <openvdb/math/Mat4.h>

#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>

#include "io/glb.h"
#include "io/mesh_builder.h"
#include "io/mesh_readers.h"
#include "io/unpack_view.h"

namespace tufa::io {
namespace {

using Json = nlohmann::json;
using Matrix = openvdb::math::Mat4d;  // row vectors: point * matrix
using Point = openvdb::math::Vec3d;

constexpr int kTriangles = 4;
constexpr int kTriangleStrip = 5;
constexpr int kTriangleFan = 6;

/// Elements of the binary chunk, `stride` bytes apart.
struct View {
  const char* data = nullptr;
  std::size_t count = 0;
  std::size_t stride = 0;
  int componentType = 0;
  bool normalized = false;  ///< integers stand for -1 to 1 or 0 to 1
};

class GlbReader {
 public:
  explicit GlbReader(const InputBytes& input) : input_(input) {}

  Mesh read() {
    splitChunks();
    refuseUnknownExtensions();
    const Json nodes = json_.value("nodes", Json::array());
    visited_.assign(nodes.size(), false);
    for (const std::size_t root : rootNodes(nodes)) addNode(nodes, root, Matrix::identity());
    return std::move(mesh_);
  }

 private:
  [[nodiscard]] std::uint32_t word(std::size_t offset) const {
    if (offset + 4 > input_.size()) input_.failAtByte(offset, "the file ends too early: truncated");
    std::uint32_t value = 0;
    std::memcpy(&value, input_.view().data() + offset, sizeof value);
    return value;
  }

  void splitChunks() {
    if (input_.size() < 12 || word(0) != glb::kMagic) input_.fail("it is not a .glb file");
    if (word(4) != 2) input_.fail("it is glTF version " + std::to_string(word(4)) + ", not 2");
    if (word(8) > input_.size()) {
      input_.fail("it should have " + std::to_string(word(8)) + " bytes but has " +
                  std::to_string(input_.size()) + ": truncated");
    }
    for (std::size_t at = 12; at + 8 <= word(8);) {
      const std::size_t length = word(at);
      const std::uint32_t type = word(at + 4);
      if (length > word(8) - at - 8) input_.failAtByte(at, "a chunk is longer than the file");
      const std::string_view chunk = input_.view().substr(at + 8, length);
      if (type == glb::kJsonChunk && json_.is_null()) json_ = Json::parse(chunk);
      if (type == glb::kBinaryChunk && binary_.data() == nullptr) binary_ = chunk;
      at += 8 + length;
    }
    if (!json_.is_object()) input_.fail("it has no JSON chunk");
  }

  void refuseUnknownExtensions() {
    for (const Json& extension : json_.value("extensionsRequired", Json::array())) {
      const std::string name = extension.get<std::string>();
      const bool onlyLooks = name.starts_with("KHR_materials") || name.starts_with("KHR_texture") ||
                             name.starts_with("EXT_texture") || name.starts_with("KHR_lights");
      const bool known = name == "KHR_mesh_quantization" || name == "EXT_meshopt_compression";
      if (!onlyLooks && !known)
        input_.fail("it needs the glTF extension " + name + ", not supported");
    }
  }

  [[nodiscard]] std::vector<std::size_t> rootNodes(const Json& nodes) const {
    std::vector<std::size_t> roots;
    const Json scenes = json_.value("scenes", Json::array());
    if (!scenes.empty()) {
      const Json& scene = scenes.at(json_.value("scene", std::size_t{0}));
      for (const Json& node : scene.value("nodes", Json::array())) roots.push_back(node);
      return roots;
    }
    std::vector<bool> isChild(nodes.size(), false);
    for (const Json& node : nodes) {
      for (const Json& child : node.value("children", Json::array())) {
        isChild.at(child.get<std::size_t>()) = true;
      }
    }
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      if (!isChild[n]) roots.push_back(n);
    }
    return roots;
  }

  static Matrix transformOf(const Json& node) {
    if (node.contains("matrix")) {
      // Column-major for column vectors is row-major for row vectors.
      const auto numbers = node.at("matrix").get<std::array<double, 16>>();
      return Matrix(numbers.data());
    }
    const auto move = node.value("translation", std::array<double, 3>{0, 0, 0});
    const auto turn = node.value("rotation", std::array<double, 4>{0, 0, 0, 1});
    const auto grow = node.value("scale", std::array<double, 3>{1, 1, 1});
    const double x = turn[0], y = turn[1], z = turn[2], w = turn[3];
    // The rotation of a unit quaternion, transposed for row vectors.
    const Point rows[3] = {
        Point(1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)) * grow[0],
        Point(2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)) * grow[1],
        Point(2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)) * grow[2]};
    Matrix matrix = Matrix::identity();
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) matrix[row][column] = rows[row][column];
      matrix[3][row] = move[row];
    }
    return matrix;
  }

  void addNode(const Json& nodes, std::size_t root, const Matrix& rootTransform) {
    std::vector<std::pair<std::size_t, Matrix>> pending{{root, rootTransform}};
    while (!pending.empty()) {
      const auto [index, parent] = pending.back();
      pending.pop_back();
      const Json& node = nodes.at(index);
      if (visited_[index]) input_.fail("node " + std::to_string(index) + " has two parents");
      visited_[index] = true;
      const Matrix transform = transformOf(node) * parent;
      if (node.contains("mesh"))
        addMesh(json_.at("meshes").at(node["mesh"].get<std::size_t>()), transform);
      for (const Json& child : node.value("children", Json::array())) {
        pending.emplace_back(child.get<std::size_t>(), transform);
      }
    }
  }

  void addMesh(const Json& mesh, const Matrix& transform) {
    for (const Json& primitive : mesh.at("primitives")) {
      const int mode = primitive.value("mode", kTriangles);
      if (mode < kTriangles || mode > kTriangleFan) continue;  // points and lines
      if (primitive.contains("extensions") &&
          primitive["extensions"].contains("KHR_draco_mesh_compression")) {
        input_.fail("its meshes are compressed by Draco, not supported");
      }
      addPrimitive(primitive, mode, transform);
    }
  }

  void addPrimitive(const Json& primitive, int mode, const Matrix& transform) {
    const View positions = viewOf(primitive.at("attributes").at("POSITION"), "VEC3", 3);
    const std::size_t first = mesh_.positions.size();
    const std::vector<VertexIndex> vertices =
        addPositions(positions, transform, primitive["attributes"].size() > 1);
    if (mesh_.positions.size() >= 0xFFFFFFFFu) input_.fail("it has too many vertices");

    const std::vector<std::uint32_t> indices = indicesOf(primitive, positions.count);
    const bool mirrored = transform.getMat3().det() < 0;
    const std::size_t step = mode == kTriangles ? 3 : 1;
    for (std::size_t n = 0; n + 2 < indices.size(); n += step) {
      const bool odd = mode == kTriangleStrip && n % 2 == 1;
      const auto at = [&](std::size_t k) {
        return static_cast<VertexIndex>(first + vertices[indices[k]]);
      };
      const VertexIndex a = at(mode == kTriangleFan ? 0 : n);
      const VertexIndex b = at(n + 1);
      const VertexIndex c = at(n + 2);
      // Every second triangle of a strip, and all of a mirrored mesh, run the other way around.
      mesh_.triangles.push_back(odd != mirrored ? Triangle(a, c, b) : Triangle(a, b, c));
    }
  }

  /// Adds the positions of a primitive and gives each one's place among them. Other attributes,
  /// such as normals at a crease, make vertices that differ at one position: `weld` makes them one
  /// again.
  std::vector<VertexIndex> addPositions(const View& view, const Matrix& transform, bool weld) {
    std::vector<Position> own;
    std::vector<VertexIndex> places(view.count);
    VertexWelder welder(own);
    for (std::size_t n = 0; n < view.count; ++n) {
      const Point moved = transform.transform(pointAt(view, n));
      if (!moved.isFinite()) input_.fail("position " + std::to_string(n) + " is not finite");
      const Position position(moved.x(), moved.y(), moved.z());
      places[n] = weld ? welder.indexOf(position) : static_cast<VertexIndex>(n);
      if (!weld) own.push_back(position);
    }
    mesh_.positions.insert(mesh_.positions.end(), own.begin(), own.end());
    return places;
  }

  template <class Number>
  static Point readPoint(const char* data) {
    std::array<Number, 3> p;
    std::memcpy(p.data(), data, sizeof p);
    return {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])};
  }

  /// Element n of a view of points: floats, or integers as KHR_mesh_quantization allows them.
  [[nodiscard]] Point pointAt(const View& view, std::size_t n) const {
    const char* const data = view.data + n * view.stride;
    const auto scaled = [&](const Point& p, double most) {
      if (!view.normalized) return p;
      return Point(std::max(-1.0, p[0] / most), std::max(-1.0, p[1] / most),
                   std::max(-1.0, p[2] / most));
    };
    switch (view.componentType) {
      case glb::kFloat:
        return readPoint<float>(data);
      case glb::kByte:
        return scaled(readPoint<std::int8_t>(data), 127);
      case glb::kUnsignedByte:
        return scaled(readPoint<std::uint8_t>(data), 255);
      case glb::kShort:
        return scaled(readPoint<std::int16_t>(data), 32767);
      case glb::kUnsignedShort:
        return scaled(readPoint<std::uint16_t>(data), 65535);
      default:
        input_.fail("its positions are of component type " + std::to_string(view.componentType) +
                    ", not supported");
    }
  }

  [[nodiscard]] std::vector<std::uint32_t> indicesOf(const Json& primitive,
                                                     std::size_t positionCount) {
    std::vector<std::uint32_t> indices;
    if (!primitive.contains("indices")) {
      for (std::size_t n = 0; n < positionCount; ++n) {
        indices.push_back(static_cast<std::uint32_t>(n));
      }
      return indices;
    }
    const View view = viewOf(primitive["indices"], "SCALAR", 1);
    indices.reserve(view.count);
    for (std::size_t n = 0; n < view.count; ++n) {
      std::uint32_t index = 0;  // little-endian: a shorter number fills the lower bytes
      std::memcpy(&index, view.data + n * view.stride, sizeOf(view.componentType));
      if (index >= positionCount) {
        input_.fail("index " + std::to_string(n) + " names vertex " + std::to_string(index) +
                    " of " + std::to_string(positionCount));
      }
      indices.push_back(index);
    }
    return indices;
  }

  [[nodiscard]] std::size_t sizeOf(int componentType) const {
    switch (componentType) {
      case glb::kByte:
      case glb::kUnsignedByte:
        return 1;
      case glb::kShort:
      case glb::kUnsignedShort:
        return 2;
      case glb::kUnsignedInt:
      case glb::kFloat:
        return 4;
      default:
        input_.fail("component type " + std::to_string(componentType) + " is not supported");
    }
  }

  /// The bytes of a buffer view: a part of the binary chunk, or unpacked from one.
  [[nodiscard]] std::string_view bytesOf(std::size_t index) {
    const Json& view = json_.at("bufferViews").at(index);
    const Json extensions = view.value("extensions", Json::object());
    if (extensions.contains("EXT_meshopt_compression")) {
      const Json& packed = extensions["EXT_meshopt_compression"];
      const auto [found, isNew] = unpacked_.try_emplace(index);
      if (isNew) found->second = unpackView(packed, partOfBinary(packed), input_);
      return found->second;
    }
    return partOfBinary(view);
  }

  [[nodiscard]] std::string_view partOfBinary(const Json& range) const {
    if (range.at("buffer") != 0 || json_.at("buffers").at(0).contains("uri")) {
      input_.fail("its data lies outside the file, not supported");
    }
    const auto start = range.value("byteOffset", std::size_t{0});
    const auto length = range.at("byteLength").get<std::size_t>();
    if (start > binary_.size() || length > binary_.size() - start) failOutside();
    return binary_.substr(start, length);
  }

  [[noreturn]] void failOutside() const {
    input_.fail("an accessor reaches beyond the binary chunk: damaged");
  }

  /// The elements of an accessor, all of them inside its buffer view.
  [[nodiscard]] View viewOf(const Json& accessorIndex, const std::string& type,
                            std::size_t components) {
    const Json& accessor = json_.at("accessors").at(accessorIndex.get<std::size_t>());
    if (accessor.contains("sparse")) input_.fail("sparse accessors are not supported");
    if (accessor.at("type") != type) input_.fail("an accessor is not of type " + type);
    const auto viewIndex = accessor.at("bufferView").get<std::size_t>();
    const std::string_view bytes = bytesOf(viewIndex);
    const Json& bufferView = json_.at("bufferViews").at(viewIndex);
    View view;
    view.componentType = accessor.at("componentType").get<int>();
    view.count = accessor.at("count").get<std::size_t>();
    const std::size_t element = components * sizeOf(view.componentType);
    view.stride = bufferView.value("byteStride", element);
    view.normalized = accessor.value("normalized", false);
    const auto offset = accessor.value("byteOffset", std::size_t{0});
    const bool inside =
        view.stride >= element && offset <= bytes.size() &&
        (view.count == 0 || (element <= bytes.size() - offset &&
                             view.count - 1 <= (bytes.size() - offset - element) / view.stride));
    if (!inside) failOutside();
    view.data = bytes.data() + offset;
    return view;
  }

  const InputBytes& input_;
  Json json_;
  std::string_view binary_;
  std::map<std::size_t, std::string> unpacked_;  ///< packed buffer views
  std::vector<bool> visited_;
  Mesh mesh_;
};

}  // namespace

Mesh readGlb(const InputBytes& input) {
  try {
    return GlbReader(input).read();
  } catch (const Json::exception& error) {
    input.fail(std::string("its JSON is damaged: ") + error.what());
  }
}

}  // namespace tufa::io
