// .glb: triangles of all meshes of the scene, through the transforms of their nodes. Of several
// LODs the finest, which alone is in the scene.

#include <array>
#include <nlohmann/json.hpp>
#include <numeric>

#include "base/vec3.h"
#include "base/vertex_welder.h"
#include "io/gltf/glb_file.h"
#include "io/gltf/node_transform.h"
#include "io/json_input.h"
#include "io/mesh/mesh_readers.h"

namespace tufa::io {
namespace {

constexpr std::size_t kTriangles = 4;
constexpr std::size_t kTriangleStrip = 5;
constexpr std::size_t kTriangleFan = 6;

class GlbReader {
 public:
  explicit GlbReader(const InputBytes& input)
      : input_(input), file_(input), json_(file_.document()) {}

  Mesh read() {
    refuseUnknownExtensions();
    const nlohmann::json& nodes = arrayAt(json_, "nodes", input_);
    visited_.assign(nodes.size(), false);
    for (const std::size_t root : rootNodes(nodes)) addNode(nodes, root, glb::NodeTransform());
    return std::move(mesh_);
  }

 private:
  void refuseUnknownExtensions() {
    for (const nlohmann::json& extension : arrayAt(json_, "extensionsRequired", input_)) {
      const std::string name = extension.get<std::string>();
      const bool onlyLooks = name.starts_with("KHR_materials") || name.starts_with("KHR_texture") ||
                             name.starts_with("EXT_texture") || name.starts_with("KHR_lights");
      const bool known = name == "KHR_mesh_quantization" || name == "EXT_meshopt_compression";
      if (!onlyLooks && !known)
        input_.fail("it needs the glTF extension " + name + ", not supported");
    }
  }

  [[nodiscard]] std::vector<std::size_t> rootNodes(const nlohmann::json& nodes) const {
    std::vector<std::size_t> roots;
    const nlohmann::json& scenes = arrayAt(json_, "scenes", input_);
    if (!scenes.empty()) {
      const nlohmann::json& scene = scenes.at(countAt(json_, "scene", 0, input_));
      for (const nlohmann::json& node : arrayAt(scene, "nodes", input_)) {
        roots.push_back(countIn(node, input_));
      }
      return roots;
    }
    std::vector<bool> isChild(nodes.size(), false);
    for (const nlohmann::json& node : nodes) {
      for (const nlohmann::json& child : arrayAt(node, "children", input_)) {
        const std::size_t number = countIn(child, input_);
        if (number >= nodes.size()) {
          input_.fail("a node has the child " + std::to_string(number) + " of " +
                      std::to_string(nodes.size()) + " nodes");
        }
        isChild[number] = true;
      }
    }
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      if (!isChild[n]) roots.push_back(n);
    }
    return roots;
  }

  static glb::NodeTransform transformOf(const nlohmann::json& node) {
    glb::NodeTransform transform;
    if (node.contains("matrix")) {
      // Column-major for column vectors is row-major for row vectors.
      const auto numbers = node.at("matrix").get<std::array<double, 16>>();
      for (int row = 0; row < 4; ++row) {
        for (int column = 0; column < 3; ++column) {
          transform.rows[row][column] = numbers[4 * row + column];
        }
      }
      return transform;
    }
    const auto move = node.value("translation", std::array<double, 3>{0, 0, 0});
    const auto turn = node.value("rotation", std::array<double, 4>{0, 0, 0, 1});
    const auto grow = node.value("scale", std::array<double, 3>{1, 1, 1});
    const double x = turn[0], y = turn[1], z = turn[2], w = turn[3];
    // The rotation of a unit quaternion, transposed for row vectors.
    transform.rows = {
        Vec3(1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)) * grow[0],
        Vec3(2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)) * grow[1],
        Vec3(2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)) * grow[2],
        Vec3(move[0], move[1], move[2])};
    return transform;
  }

  void addNode(const nlohmann::json& nodes, std::size_t root,
               const glb::NodeTransform& rootTransform) {
    std::vector<std::pair<std::size_t, glb::NodeTransform>> pending{{root, rootTransform}};
    while (!pending.empty()) {
      const auto [index, parent] = pending.back();
      pending.pop_back();
      const nlohmann::json& node = nodes.at(index);
      if (visited_[index]) input_.fail("node " + std::to_string(index) + " has two parents");
      visited_[index] = true;
      const glb::NodeTransform transform = transformOf(node).under(parent);
      if (node.contains("mesh"))
        addMesh(json_.at("meshes").at(countIn(node["mesh"], input_)), transform);
      for (const nlohmann::json& child : arrayAt(node, "children", input_)) {
        pending.emplace_back(countIn(child, input_), transform);
      }
    }
  }

  // The positions of a mesh while its primitives are added. Equal ones become one vertex where
  // there is more to a vertex than its position, such as a normal at a crease, or more than one
  // primitive, as of several materials.
  struct Positions {
    std::vector<Position> all;
    base::VertexWelder welder{all};
    bool weld;
  };

  void addMesh(const nlohmann::json& mesh, const glb::NodeTransform& transform) {
    const nlohmann::json& primitives = mesh.at("primitives");
    Positions positions;
    positions.weld = primitives.size() > 1;
    for (const nlohmann::json& primitive : primitives) {
      positions.weld |= primitive.at("attributes").size() > 1;
    }
    for (const nlohmann::json& primitive : primitives) {
      const std::size_t mode = countAt(primitive, "mode", kTriangles, input_);
      if (mode < kTriangles || mode > kTriangleFan) continue;  // points and lines
      if (primitive.contains("extensions") &&
          primitive["extensions"].contains("KHR_draco_mesh_compression")) {
        input_.fail("its meshes are compressed by Draco, not supported");
      }
      addPrimitive(primitive, mode, transform, positions);
    }
    mesh_.positions.insert(mesh_.positions.end(), positions.all.begin(), positions.all.end());
  }

  void addPrimitive(const nlohmann::json& primitive, std::size_t mode,
                    const glb::NodeTransform& transform, Positions& positions) {
    const glb::View view = file_.viewOf(primitive.at("attributes").at("POSITION"), "VEC3", 3);
    const std::size_t first = mesh_.positions.size();
    const std::vector<VertexIndex> vertices = addPositions(view, transform, positions);
    if (first + positions.all.size() >= 0xFFFFFFFFu) input_.fail("it has too many vertices");

    const std::vector<std::uint32_t> indices = indicesOf(primitive, view.count);
    file_.takeMemory(mode == kTriangles ? indices.size() / 3 : indices.size(), sizeof(Triangle));
    const bool mirrored = transform.isMirrored();
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

  /// Adds the positions of a primitive and gives each one's place among those of its mesh.
  std::vector<VertexIndex> addPositions(const glb::View& view, const glb::NodeTransform& transform,
                                        Positions& to) {
    file_.takeMemory(view.count, sizeof(Position) + sizeof(VertexIndex));
    std::vector<VertexIndex> places(view.count);
    for (std::size_t n = 0; n < view.count; ++n) {
      const Vec3 moved = transform.ofPoint(file_.pointAt(view, n));
      if (!moved.isFinite()) input_.fail("position " + std::to_string(n) + " is not finite");
      const Position position = moved;
      places[n] = to.weld ? to.welder.indexOf(position) : static_cast<VertexIndex>(to.all.size());
      if (!to.weld) to.all.push_back(position);
    }
    return places;
  }

  [[nodiscard]] std::vector<std::uint32_t> indicesOf(const nlohmann::json& primitive,
                                                     std::size_t positionCount) {
    if (primitive.contains("indices")) return file_.indicesOf(primitive["indices"], positionCount);
    std::vector<std::uint32_t> indices(positionCount);
    std::iota(indices.begin(), indices.end(), 0u);
    return indices;
  }

  const InputBytes& input_;
  glb::File file_;
  const nlohmann::json& json_;
  std::vector<bool> visited_;
  Mesh mesh_;
};

}  // namespace

Mesh readGlb(const InputBytes& input) {
  try {
    return GlbReader(input).read();
  } catch (const nlohmann::json::exception& error) {
    input.fail(std::string("its JSON is damaged: ") + error.what());
  }
}

}  // namespace tufa::io
