#pragma once

#include <tufa/attributes.h>
#include <tufa/io.h>

#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace tufa::tools {

/// What the vertices get from grids of the file.
struct AttributeWords {
  std::vector<std::string> grids;       ///< such as "temperature" and "Cd=colour"
  std::optional<std::string> velocity;  ///< the name of a grid
  std::optional<std::string> shutter;   ///< seconds: "0.02" or "1/48"

  [[nodiscard]] bool empty() const { return grids.empty() && !velocity; }
};

/// Declares `--attribute`, `--velocity` and `--shutter`.
void addAttributeOptions(CLI::App& app, AttributeWords& words,
                         const std::string& formats = ".ply, .glb and .usda");

/// The seconds that `--shutter` says. Throws Error(InvalidArgument) for what says none.
[[nodiscard]] double readShutter(const AttributeWords& words);

/// Throws Error(InvalidArgument) for words that mean no attribute, or twice the same grid, and for
/// a format that holds none.
void requireAttributes(const AttributeWords& words, MeshFormat format);

/// The grids of a file that attributes are sampled from. To be made before a mesh is, so that words
/// that name none, or one that cannot be sampled, are told at once.
class AttributeGrids {
 public:
  /// Reads the grids that words name. Throws Error, also if one cannot be sampled.
  AttributeGrids(const std::string& file, const AttributeWords& words);

  /// Samples them at places in world space.
  [[nodiscard]] std::vector<Attribute> sample(std::span<const Position> positions,
                                              int threads) const;

 private:
  struct Source {
    std::shared_ptr<openvdb::GridBase> grid;
    std::string name;
    AttributeRole role = AttributeRole::Value;
    double factor = 1;
  };
  std::vector<Source> sources_;
};

/// "temperature, vel (3), motion by vel", for a summary.
[[nodiscard]] std::string describe(const std::vector<Attribute>& attributes);

/// A list of names and widths, for programs; motions have the seconds that they are of.
[[nodiscard]] nlohmann::ordered_json toJson(const std::vector<Attribute>& attributes,
                                            const AttributeWords& words);

}  // namespace tufa::tools
