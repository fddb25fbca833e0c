#include "io/mesh/file_attributes.h"

#include <tufa/error.h>
#include <algorithm>
#include <cmath>
#include <set>
#include <string_view>
#include <utility>

#include "base/known_enum.h"

namespace tufa::io {
namespace {

constexpr int kMostValues = 4;

std::string upperName(const std::string& name) {
  std::string upper(1, '_');
  upper += plainName(name);
  std::transform(upper.begin(), upper.end(), upper.begin(), [](char c) {
    return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  });
  return upper;
}

/// What programs take for something else.
bool hasMeaningInPly(std::string_view name) {
  constexpr std::array<std::string_view, 12> kTaken = {"x", "y",   "z",     "nx",   "ny",    "nz",
                                                       "s", "red", "green", "blue", "alpha", "t"};
  return std::find(kTaken.begin(), kTaken.end(), name) != kTaken.end();
}

/// The properties of an attribute of that name, one for each of its values.
std::vector<std::string> plyNames(const Attribute& attribute, std::string name) {
  if (hasMeaningInPly(name)) name = std::string("attribute_").append(name);
  if (attribute.width == 1) return {name};
  std::vector<std::string> names;
  for (int i = 0; i < attribute.width; ++i) {
    names.push_back(name);
    const char* const letters = attribute.role == AttributeRole::Colour ? "rgb" : "xyzw";
    names.back().append(1, '_').append(1, letters[i]);
  }
  return names;
}

bool areFree(const std::vector<std::string>& names, const std::set<std::string>& taken) {
  return std::none_of(names.begin(), names.end(),
                      [&](const std::string& name) { return taken.contains(name); });
}

}  // namespace

std::string plainName(const std::string& name) {
  std::string plain = name;
  for (char& c : plain) {
    const bool kept = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    if (!kept) c = '_';
  }
  return plain;
}

void requireSoundAttributes(const std::vector<Attribute>& attributes, std::size_t positions,
                            bool holdsMotions) {
  for (const Attribute& attribute : attributes) {
    const auto refuse = [&](const std::string& why) {
      throw Error(ErrorCode::InvalidArgument, "attribute \"" + attribute.name + "\" " + why);
    };
    if (attribute.width < 1 || attribute.width > kMostValues) {
      refuse("has a width of " + std::to_string(attribute.width) + "; it must be 1 to 4");
    }
    base::requireKnown(attribute.role, AttributeRole::Motion, "the role of an attribute");
    if (attribute.name.empty()) refuse("has no name");
    const bool motion = attribute.role == AttributeRole::Motion;
    if (attribute.role != AttributeRole::Value && attribute.width != 3) {
      refuse(std::string("is a ") + (motion ? "motion" : "colour") + " of " +
             std::to_string(attribute.width) + " values; it must have 3");
    }
    if (motion && !holdsMotions) refuse("is a motion, which only .glb holds");
    const std::size_t due = static_cast<std::size_t>(attribute.width) * positions;
    if (attribute.values.size() != due) {
      refuse("has " + std::to_string(attribute.values.size()) + " values; " +
             std::to_string(positions) + " positions need " + std::to_string(due));
    }
    if (!std::all_of(attribute.values.begin(), attribute.values.end(),
                     [](float value) { return std::isfinite(value); })) {
      refuse("has values that are not finite");
    }
  }
}

std::vector<std::vector<std::string>> plyNames(const std::vector<Attribute>& attributes) {
  std::set<std::string> taken;
  std::vector<std::vector<std::string>> all;
  for (const Attribute& attribute : attributes) {
    std::vector<std::string> names;
    const bool isColour = attribute.role == AttributeRole::Colour;
    if (isColour) names = {"red", "green", "blue"};
    // Programs show the first colour.
    for (int n = 1; names.empty() || !areFree(names, taken); ++n) {
      const std::string number = n == 1 ? "" : std::string(1, '_').append(std::to_string(n));
      names = plyNames(attribute, plainName(attribute.name) + number);
    }
    taken.insert(names.begin(), names.end());
    all.push_back(std::move(names));
  }
  return all;
}

std::string plyProperties(const std::vector<Attribute>& attributes) {
  std::string lines;
  const std::vector<std::vector<std::string>> names = plyNames(attributes);
  for (std::size_t i = 0; i < attributes.size(); ++i) {
    const bool bytes = attributes[i].role == AttributeRole::Colour;
    for (const std::string& name : names[i]) {
      lines += std::string("property ") + (bytes ? "uchar " : "float ") + name + "\n";
    }
  }
  return lines;
}

std::vector<std::string> gltfNames(const std::vector<Attribute>& attributes) {
  std::set<std::string> taken;
  std::vector<std::string> names;
  std::size_t colours = 0;
  for (const Attribute& attribute : attributes) {
    if (attribute.role == AttributeRole::Motion) {
      names.emplace_back();
      continue;
    }
    std::string name = upperName(attribute.name);
    if (attribute.role == AttributeRole::Colour) name = "COLOR_" + std::to_string(colours++);
    std::string unique = name;
    for (int n = 2; !taken.insert(unique).second; ++n) {
      unique = name;
      unique.append(1, '_').append(std::to_string(n));
    }
    names.push_back(std::move(unique));
  }
  return names;
}

const char* gltfType(const Attribute& attribute) {
  constexpr std::array kTypes = {"SCALAR", "VEC2", "VEC3", "VEC4"};
  return kTypes[static_cast<std::size_t>(attribute.width - 1)];
}

float gltfValue(const Attribute& attribute, std::size_t index) {
  const float value = attribute.values[index];
  return attribute.role == AttributeRole::Colour ? std::clamp(value, 0.0F, 1.0F) : value;
}

std::uint8_t colourByte(float linear) {
  // IEC 61966-2-1.
  const double value = std::clamp(static_cast<double>(linear), 0.0, 1.0);
  const double encoded =
      value <= 0.0031308 ? 12.92 * value : 1.055 * std::pow(value, 1 / 2.4) - 0.055;
  return static_cast<std::uint8_t>(std::lround(255 * encoded));
}

}  // namespace tufa::io
