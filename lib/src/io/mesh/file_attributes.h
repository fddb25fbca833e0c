#pragma once

#include <tufa/mesh.h>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace tufa::io {

// How attributes are named and stored in files.

/// A name with an underscore for all that is neither a letter nor a digit.
[[nodiscard]] std::string plainName(const std::string& name);

/// Throws Error(InvalidArgument) unless every attribute has a name and as many values, all finite,
/// as its width and the number of positions ask for, and a colour or a motion has three; and where
/// the format holds no motions, unless there are none.
void requireSoundAttributes(const std::vector<Attribute>& attributes, std::size_t positions,
                            bool holdsMotions);

/// The names of the properties of a mesh's attributes in .ply, for each one for each of its values:
/// red, green and blue for the first colour. Nothing that a property may not be called, else none
/// that .ply gives a meaning, and no name twice.
[[nodiscard]] std::vector<std::vector<std::string>> plyNames(
    const std::vector<Attribute>& attributes);

/// The names of a mesh's attributes in glTF: COLOR_0 for the first colour, else _NAME; empty for
/// motions. No name twice.
[[nodiscard]] std::vector<std::string> gltfNames(const std::vector<Attribute>& attributes);

/// The type of an attribute's accessor in glTF.
[[nodiscard]] const char* gltfType(const Attribute& attribute);

/// The values of an attribute at a position, as floats in glTF has them: colours from 0 to 1.
[[nodiscard]] float gltfValue(const Attribute& attribute, std::size_t index);

/// A linear colour as a byte of sRGB.
[[nodiscard]] std::uint8_t colourByte(float linear);

/// The lines of the attributes' properties in the header of a .ply.
[[nodiscard]] std::string plyProperties(const std::vector<Attribute>& attributes);

/// Calls add() with the values of an attribute at a position as a .ply holds them: bytes of a
/// colour, else floats.
template <class Add>
void forPlyValues(const Attribute& attribute, std::size_t position, const Add& add) {
  const auto width = static_cast<std::size_t>(attribute.width);
  for (std::size_t i = position * width; i < (position + 1) * width; ++i) {
    if (attribute.role == AttributeRole::Colour) {
      add(colourByte(attribute.values[i]));
    } else {
      add(attribute.values[i]);
    }
  }
}

}  // namespace tufa::io
