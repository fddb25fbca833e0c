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

/// Throws Error(InvalidArgument) unless every attribute has as many values as its width and the
/// number of positions ask for, and a colour or a motion has three; and where the format holds no
/// motions, unless there are none.
void requireSoundAttributes(const std::vector<Attribute>& attributes, std::size_t positions,
                            bool holdsMotions);

/// The names of an attribute's properties in .ply, one for each of its values. Nothing that a
/// property may not be called, and none that .ply gives a meaning.
[[nodiscard]] std::vector<std::string> plyNames(const Attribute& attribute);

/// The name of an attribute in glTF: COLOR_0 for the first colour, else _NAME. `attributes` are all
/// of the mesh, of which it is the one at `index`; no two get one name.
[[nodiscard]] std::string gltfName(const std::vector<Attribute>& attributes, std::size_t index);

/// The type of an attribute's accessor in glTF.
[[nodiscard]] const char* gltfType(const Attribute& attribute);

/// The values of an attribute at a position, as floats in glTF has them: colours from 0 to 1.
[[nodiscard]] float gltfValue(const Attribute& attribute, std::size_t index);

/// A linear colour as a byte of sRGB.
[[nodiscard]] std::uint8_t colourByte(float linear);

/// The lines of an attribute's properties in the header of a .ply.
[[nodiscard]] std::string plyProperties(const Attribute& attribute);

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
