// .ply: text and binary of either byte order, with any elements and properties.

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <optional>

#include "io/mesh/mesh_builder.h"
#include "io/mesh/mesh_readers.h"

namespace tufa::io {
namespace {

enum class Type { Int8, Uint8, Int16, Uint16, Int32, Uint32, Float32, Float64 };

struct Property {
  std::string name;
  Type type = Type::Float32;
  std::optional<Type> countType;  ///< set for lists
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

enum class Encoding { Text, LittleEndian, BigEndian };

struct Header {
  Encoding encoding = Encoding::Text;
  std::vector<Element> elements;
  std::size_t bytes = 0;  ///< up to the first byte of data
  std::size_t lines = 0;
};

std::optional<Type> typeByName(std::string_view name) {
  struct Names {
    std::string_view classic, sized;
  };
  static constexpr std::array<Names, 8> kNames{{{"char", "int8"},
                                                {"uchar", "uint8"},
                                                {"short", "int16"},
                                                {"ushort", "uint16"},
                                                {"int", "int32"},
                                                {"uint", "uint32"},
                                                {"float", "float32"},
                                                {"double", "float64"}}};
  for (std::size_t n = 0; n < kNames.size(); ++n) {
    if (name == kNames[n].classic || name == kNames[n].sized) return static_cast<Type>(n);
  }
  return std::nullopt;
}

std::size_t sizeOf(Type type) {
  static constexpr std::array<std::size_t, 8> kSizes{1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[static_cast<std::size_t>(type)];
}

Type nextType(TextCursor& text) {
  const std::string_view word = text.nextWord();
  const auto type = typeByName(word);
  if (!type) text.fail("unknown type \"" + std::string(word.substr(0, 40)) + "\"");
  return *type;
}

Encoding nextEncoding(TextCursor& text) {
  const std::string_view word = text.nextWord();
  if (word == "binary_little_endian") return Encoding::LittleEndian;
  if (word == "binary_big_endian") return Encoding::BigEndian;
  if (word != "ascii") text.fail("unknown format \"" + std::string(word.substr(0, 40)) + "\"");
  return Encoding::Text;
}

Property nextProperty(TextCursor& text) {
  Property property;
  const std::string_view word = text.nextWord();
  if (word == "list") {
    property.countType = nextType(text);
    property.type = nextType(text);
  } else if (const auto type = typeByName(word)) {
    property.type = *type;
  } else {
    text.fail("unknown type \"" + std::string(word.substr(0, 40)) + "\"");
  }
  property.name = text.nextWord();
  return property;
}

Header readHeader(const InputBytes& input) {
  TextCursor text(input, 0, 1);
  if (!text.nextLine() || text.nextWord() != "ply") input.fail("it is not a .ply file");
  Header header;
  bool formatSeen = false;
  while (text.nextLine()) {
    const std::string_view keyword = text.nextWord();
    if (keyword == "end_header") {
      if (!formatSeen) text.fail("the header names no format");
      header.bytes = input.size() - text.bytesLeft();
      header.lines = text.line();
      return header;
    }
    if (keyword == "format") {
      header.encoding = nextEncoding(text);
      formatSeen = true;
    } else if (keyword == "element") {
      Element& element = header.elements.emplace_back();
      element.name = text.nextWord();
      const std::int64_t count = text.nextInteger();
      if (count < 0) text.fail("a count is negative");
      element.count = static_cast<std::uint64_t>(count);
    } else if (keyword == "property") {
      if (header.elements.empty()) text.fail("a property before any element");
      header.elements.back().properties.push_back(nextProperty(text));
    } else if (keyword != "comment" && keyword != "obj_info" && !keyword.empty()) {
      text.fail("unknown keyword in the header");
    }
  }
  text.fail("the header does not end");
}

/// Numbers of a binary body.
class BinaryBody {
 public:
  BinaryBody(const InputBytes& input, const Header& header)
      : input_(input),
        at_(header.bytes),
        swap_((header.encoding == Encoding::BigEndian) ==
              (std::endian::native == std::endian::little)) {}

  double next(Type type) {
    switch (type) {
      case Type::Int8:
        return take<std::int8_t>();
      case Type::Uint8:
        return take<std::uint8_t>();
      case Type::Int16:
        return take<std::int16_t>();
      case Type::Uint16:
        return take<std::uint16_t>();
      case Type::Int32:
        return take<std::int32_t>();
      case Type::Uint32:
        return take<std::uint32_t>();
      case Type::Float32:
        return take<float>();
      case Type::Float64:
        return take<double>();
    }
    return 0;
  }
  [[nodiscard]] std::size_t bytesLeft() const { return input_.size() - at_; }
  [[nodiscard]] std::size_t leastBytes(Type type) const { return sizeOf(type); }
  [[noreturn]] void fail(const std::string& cause) const { input_.failAtByte(at_, cause); }

 private:
  template <class Number>
  double take() {
    if (bytesLeft() < sizeof(Number)) fail("the file ends too early: truncated");
    std::array<char, sizeof(Number)> bytes;
    std::memcpy(bytes.data(), input_.view().data() + at_, sizeof(Number));
    if (swap_) std::reverse(bytes.begin(), bytes.end());
    at_ += sizeof(Number);
    return static_cast<double>(std::bit_cast<Number>(bytes));
  }

  const InputBytes& input_;
  std::size_t at_;
  bool swap_;
};

/// Numbers of a text body.
class TextBody {
 public:
  TextBody(const InputBytes& input, const Header& header)
      : text_(input, header.bytes, header.lines + 1) {}

  double next(Type /*type*/) { return text_.parseNumber(text_.nextWordAnywhere()); }
  [[nodiscard]] std::size_t bytesLeft() const { return text_.bytesLeft(); }
  [[nodiscard]] std::size_t leastBytes(Type /*type*/) const { return 1; }
  [[noreturn]] void fail(const std::string& cause) const { text_.fail(cause); }

 private:
  TextCursor text_;
};

/// Reads the elements after the header into a mesh.
template <class Body>
class BodyReader {
 public:
  BodyReader(const Header& header, Body body, std::vector<std::uint8_t>* parts)
      : header_(header), body_(std::move(body)), parts_(parts) {}

  Mesh read() {
    bool hasVertices = false;
    for (const Element& element : header_.elements) {
      if (element.name == "tristrips") body_.fail("triangle strips are not supported");
      if (element.name != "vertex") continue;
      if (hasVertices) body_.fail("there are two elements \"vertex\"");
      if (element.properties.empty()) body_.fail("the vertices have no x");
      hasVertices = true;
      vertexCount_ = element.count;
    }
    for (const Element& element : header_.elements) {
      if (element.properties.empty()) continue;
      requirePossible(element);
      if (element.name == "vertex") {
        readVertices(element);
      } else if (element.name == "face") {
        readFaces(element);
      } else {
        for (std::uint64_t n = 0; n < element.count; ++n) skip(element);
      }
    }
    return std::move(builder_.mesh());
  }

 private:
  /// Refuses counts that the rest of the file has no room for, before any memory is taken for them.
  void requirePossible(const Element& element) {
    std::size_t least = 0;
    for (const Property& property : element.properties) {
      least += body_.leastBytes(property.countType.value_or(property.type));
    }
    if (element.count <= body_.bytesLeft() / least) return;
    body_.fail(std::to_string(element.count) + " elements \"" + element.name.substr(0, 40) +
               "\" need more than the " + std::to_string(body_.bytesLeft()) +
               " bytes that follow: truncated or damaged");
  }

  std::uint64_t nextCount(Type type) {
    const double count = body_.next(type);
    if (!(count >= 0) || count > static_cast<double>(body_.bytesLeft())) {
      body_.fail("a list is longer than the file: damaged");
    }
    return static_cast<std::uint64_t>(count);
  }

  void skip(const Property& property) {
    std::uint64_t count = property.countType ? nextCount(*property.countType) : 1;
    for (; count > 0; --count) body_.next(property.type);
  }

  void skip(const Element& element) {
    for (const Property& property : element.properties) skip(property);
  }

  static std::optional<std::size_t> find(const Element& element, std::string_view name) {
    for (std::size_t n = 0; n < element.properties.size(); ++n) {
      if (element.properties[n].name == name && !element.properties[n].countType) return n;
    }
    return std::nullopt;
  }

  void readVertices(const Element& element) {
    std::vector<int> slots(element.properties.size(), -1);  // of x, y, z, nx, ny, nz
    int found = 0;
    static constexpr std::array<std::string_view, 6> kNames{"x", "y", "z", "nx", "ny", "nz"};
    for (std::size_t n = 0; n < kNames.size(); ++n) {
      const auto property = find(element, kNames[n]);
      if (!property && n < 3) body_.fail("the vertices have no " + std::string(kNames[n]));
      if (!property) break;
      slots[*property] = static_cast<int>(n);
      ++found;
    }
    const bool normals = found == 6;
    Mesh& mesh = builder_.mesh();
    mesh.positions.reserve(element.count);
    if (normals) mesh.normals.reserve(element.count);
    for (std::uint64_t n = 0; n < element.count; ++n) {
      std::array<double, 6> values{};
      for (std::size_t k = 0; k < slots.size(); ++k) {
        if (slots[k] < 0) {
          skip(element.properties[k]);
        } else {
          values[slots[k]] = body_.next(element.properties[k].type);
        }
      }
      if (!std::isfinite(values[0]) || !std::isfinite(values[1]) || !std::isfinite(values[2])) {
        body_.fail("a coordinate of vertex " + std::to_string(n) + " is not finite");
      }
      mesh.positions.emplace_back(values[0], values[1], values[2]);
      if (normals) {
        mesh.normals.emplace_back(static_cast<float>(values[3]), static_cast<float>(values[4]),
                                  static_cast<float>(values[5]));
      }
    }
  }

  static bool isCorners(const Property& property) {
    return property.countType &&
           (property.name == "vertex_indices" || property.name == "vertex_index");
  }

  void readFaces(const Element& element) {
    std::vector<std::uint64_t> corners;
    const MeshBuilder::Fail fail = [this](const std::string& cause) { body_.fail(cause); };
    const auto hasCorners = std::any_of(element.properties.begin(), element.properties.end(),
                                        [](const Property& p) { return isCorners(p); });
    if (element.count > 0 && !hasCorners) fail("its faces have no list vertex_indices");
    for (std::uint64_t n = 0; n < element.count; ++n) {
      for (const Property& property : element.properties) {
        if (!isCorners(property)) {
          const bool isPart = parts_ && !property.countType && property.name == "part" &&
                              property.type == Type::Uint8;
          if (isPart) {
            const double part = body_.next(property.type);  // a text may hold any number
            parts_->push_back(part >= 0 && part <= 255 ? static_cast<std::uint8_t>(part) : 255);
          } else {
            skip(property);
          }
          continue;
        }
        corners.resize(nextCount(*property.countType));
        for (std::uint64_t& corner : corners) {
          const double index = body_.next(property.type);
          if (!(index >= 0)) fail("a face names a vertex below zero");
          if (index != std::floor(index)) fail("a face names a vertex by no whole number");
          corner = static_cast<std::uint64_t>(std::min(index, 0x1p60));
        }
        builder_.addFace(corners, vertexCount_, fail);
      }
    }
  }

  const Header& header_;
  Body body_;
  std::vector<std::uint8_t>* parts_;
  MeshBuilder builder_;
  std::uint64_t vertexCount_ = 0;
};

}  // namespace

Mesh readPly(const InputBytes& input, std::vector<std::uint8_t>* parts) {
  const Header header = readHeader(input);
  if (header.encoding == Encoding::Text) {
    return BodyReader<TextBody>(header, TextBody(input, header), parts).read();
  }
  return BodyReader<BinaryBody>(header, BinaryBody(input, header), parts).read();
}

}  // namespace tufa::io
