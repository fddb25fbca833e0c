#pragma once

#include <tufa/attributes.h>
#include <tufa/io.h>

#include <memory>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace tufa::tools {

/// Declares `--attribute`: words such as "temperature" and "Cd=colour".
void addAttributeOption(CLI::App& app, std::vector<std::string>& words);

/// Throws Error(InvalidArgument) for words that mean no attribute, or twice the same grid, and for
/// a format that holds none.
void requireAttributes(const std::vector<std::string>& words, MeshFormat format);

/// The grids of a file that attributes are sampled from.
class AttributeGrids {
 public:
  /// Reads the grids that words name. Throws Error.
  AttributeGrids(const std::string& file, const std::vector<std::string>& words);

  /// Samples them at a mesh's vertices, into Mesh::attributes.
  void sample(Mesh& mesh, int threads) const;

 private:
  struct Source {
    std::shared_ptr<openvdb::GridBase> grid;
    std::string name;
    AttributeRole role = AttributeRole::Value;
  };
  std::vector<Source> sources_;
};

/// "temperature, vel (3)", for a summary.
[[nodiscard]] std::string describe(const std::vector<Attribute>& attributes);

}  // namespace tufa::tools
