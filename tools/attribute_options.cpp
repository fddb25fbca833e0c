#include "attribute_options.h"

#include <CLI/CLI.hpp>

#include <tufa/error.h>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "number.h"
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

void addAttributeOptions(CLI::App& app, AttributeWords& words, const std::string& formats) {
  app.add_option("--attribute", words.grids,
                 "a grid of the file whose values the vertices get, in " + formats +
                     "; with =colour as colours")
      ->allow_extra_args(false);
  app.add_option(
      "--velocity", words.velocity,
      ".glb: a grid of the file with velocities in world units per second, for positions "
      "at the end of --shutter as a morph target");
  app.add_option("--shutter", words.shutter,
                 "with --velocity: how long the vertices move, in seconds, such as 0.02 or 1/48");
}

double readShutter(const AttributeWords& words) {
  const std::string text = words.shutter.value_or("");
  const std::size_t bar = text.find('/');
  std::optional<double> seconds = numberIn<double>(text.substr(0, bar));
  if (seconds && bar != std::string::npos) {
    const std::optional<double> parts = numberIn<double>(text.substr(bar + 1));
    seconds = parts ? std::optional(*seconds / *parts) : std::nullopt;
  }
  if (seconds && std::isfinite(*seconds) && *seconds != 0) return *seconds;
  throw Error(ErrorCode::InvalidArgument,
              "--shutter takes seconds other than 0, such as 0.02 or 1/48, not \"" + text + "\"");
}

void requireAttributes(const AttributeWords& words, MeshFormat format) {
  std::vector<std::string> grids;
  for (const std::string& text : words.grids) {
    grids.push_back(readWord(text).grid);
    if (std::count(grids.begin(), grids.end(), grids.back()) == 1) continue;
    throw Error(ErrorCode::InvalidArgument, "--attribute names " + grids.back() + " twice");
  }
  if (words.velocity.has_value() != words.shutter.has_value()) {
    throw Error(ErrorCode::InvalidArgument,
                words.velocity ? "--velocity needs --shutter, the seconds that the vertices move"
                               : "--shutter needs --velocity, the grid that moves the vertices");
  }
  if (words.velocity && format != MeshFormat::Glb) {
    throw Error(ErrorCode::InvalidArgument, "--velocity makes a morph target, for .glb only");
  }
  if (words.velocity) static_cast<void>(readShutter(words));
  const bool holds =
      format == MeshFormat::Ply || format == MeshFormat::Glb || format == MeshFormat::Usda;
  if (words.grids.empty() || holds) return;
  throw Error(ErrorCode::InvalidArgument, "--attribute is for .ply, .glb and .usda only");
}

AttributeGrids::AttributeGrids(const std::string& file, const AttributeWords& words) {
  for (const std::string& text : words.grids) {
    const Word word = readWord(text);
    sources_.push_back({readVolume(file, word.grid), word.grid, word.role});
  }
  if (words.velocity) {
    sources_.push_back({readVolume(file, *words.velocity), *words.velocity, AttributeRole::Motion,
                        readShutter(words)});
  }
  static_cast<void>(sample({}, 1));  // throws what sampling would
}

std::vector<Attribute> AttributeGrids::sample(std::span<const Position> positions,
                                              int threads) const {
  std::vector<Attribute> attributes;
  for (const Source& source : sources_) {
    AttributeOptions options;
    options.name = source.name;
    options.role = source.role;
    options.factor = source.factor;
    options.threads = threads;
    attributes.push_back(sampleAttribute(positions, *source.grid, options));
  }
  return attributes;
}

std::string describe(const std::vector<Attribute>& attributes) {
  std::string text;
  for (const Attribute& attribute : attributes) {
    const bool motion = attribute.role == AttributeRole::Motion;
    text += std::string(text.empty() ? "" : ", ") + (motion ? "motion by " : "") + attribute.name;
    if (!motion && attribute.width > 1) text += " (" + std::to_string(attribute.width) + ")";
  }
  return text;
}

nlohmann::ordered_json toJson(const std::vector<Attribute>& attributes,
                              const AttributeWords& words) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const Attribute& attribute : attributes) {
    json.push_back({{"name", attribute.name}, {"width", attribute.width}});
    if (attribute.role == AttributeRole::Motion) json.back()["shutter"] = readShutter(words);
  }
  return json;
}

}  // namespace tufa::tools
