#include "io/mesh/file_attributes.h"

#include <tufa/error.h>
#include <algorithm>
#include <cmath>
#include <string_view>

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
  }
}

std::vector<std::string> plyNames(const Attribute& attribute) {
  if (attribute.role == AttributeRole::Colour) return {"red", "green", "blue"};
  std::string name = plainName(attribute.name);
  if (hasMeaningInPly(name)) name = std::string("attribute_").append(name);
  if (attribute.width == 1) return {name};
  std::vector<std::string> names;
  for (int i = 0; i < attribute.width; ++i) {
    names.push_back(name);
    names.back().append(1, '_').append(1, "xyzw"[static_cast<std::size_t>(i)]);
  }
  return names;
}

std::string plyProperties(const Attribute& attribute) {
  const bool bytes = attribute.role == AttributeRole::Colour;
  std::string lines;
  for (const std::string& name : plyNames(attribute)) {
    lines += std::string("property ") + (bytes ? "uchar " : "float ") + name + "\n";
  }
  return lines;
}

std::string gltfName(const std::vector<Attribute>& attributes, std::size_t index) {
  std::size_t before = 0;
  if (attributes[index].role == AttributeRole::Colour) {
    for (std::size_t i = 0; i < index; ++i) {
      if (attributes[i].role == AttributeRole::Colour) ++before;
    }
    return "COLOR_" + std::to_string(before);
  }
  const std::string name = upperName(attributes[index].name);
  for (std::size_t i = 0; i < index; ++i) {
    const bool same =
        attributes[i].role == AttributeRole::Value && upperName(attributes[i].name) == name;
    if (same) ++before;
  }
  if (before == 0) return name;
  return std::string(name).append(1, '_').append(std::to_string(before + 1));
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
