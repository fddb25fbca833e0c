#include "attribute_options.h"

#include <CLI/CLI.hpp>

#include <tufa/error.h>
#include <algorithm>
#include <optional>

#include "volume.h"

namespace tufa::tools {
namespace {

struct Word {
  std::string grid;
  AttributeRole role = AttributeRole::Value;
};

Word readWord(const std::string& text) {
  // The last =, for a grid's name may have one.
  const std::size_t sign = text.rfind('=');
  Word word{text.substr(0, sign)};
  if (sign == std::string::npos) return word;
  const std::string role = text.substr(sign + 1);
  if (role == "colour" || role == "color") {
    word.role = AttributeRole::Colour;
  } else if (role != "value") {
    throw Error(ErrorCode::InvalidArgument,
                "--attribute " + text + ": behind the = stands colour, color or value, not \"" +
                    role + "\"");
  }
  return word;
}

}  // namespace

void addAttributeOption(CLI::App& app, std::vector<std::string>& words) {
  app.add_option(
         "--attribute", words,
         "a grid of the file whose values the vertices get, in .ply, .glb and .usda; with =colour "
         "as colours")
      ->allow_extra_args(false);
}

void requireAttributes(const std::vector<std::string>& words, MeshFormat format) {
  std::vector<std::string> grids;
  for (const std::string& text : words) {
    grids.push_back(readWord(text).grid);
    if (std::count(grids.begin(), grids.end(), grids.back()) == 1) continue;
    throw Error(ErrorCode::InvalidArgument, "--attribute names " + grids.back() + " twice");
  }
  const bool holds =
      format == MeshFormat::Ply || format == MeshFormat::Glb || format == MeshFormat::Usda;
  if (words.empty() || holds) return;
  throw Error(ErrorCode::InvalidArgument, "--attribute is for .ply, .glb and .usda only");
}

AttributeGrids::AttributeGrids(const std::string& file, const std::vector<std::string>& words) {
  for (const std::string& text : words) {
    const Word word = readWord(text);
    sources_.push_back({readVolume(file, word.grid), word.grid, word.role});
  }
}

void AttributeGrids::sample(Mesh& mesh, int threads) const {
  for (const Source& source : sources_) {
    AttributeOptions options;
    options.name = source.name;
    options.role = source.role;
    options.threads = threads;
    mesh.attributes.push_back(sampleAttribute(mesh, *source.grid, options));
  }
}

std::string describe(const std::vector<Attribute>& attributes) {
  std::string text;
  for (const Attribute& attribute : attributes) {
    text += (text.empty() ? "" : ", ") + attribute.name;
    if (attribute.width > 1) text += " (" + std::to_string(attribute.width) + ")";
  }
  return text;
}

}  // namespace tufa::tools
