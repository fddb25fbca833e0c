// .obj and .off.

#include <algorithm>
#include <limits>

#include "io/mesh/mesh_builder.h"
#include "io/mesh/mesh_readers.h"

namespace tufa::io {
namespace {

Position nextPosition(TextCursor& text) {
  const double x = text.nextNumber();
  const double y = text.nextNumber();
  const double z = text.nextNumber();
  return {x, y, z};
}

/// The position that a corner such as "7", "7/1", "7//3" or "-1/-1/-1" names. Positive numbers
/// count from one, negative ones back from the last position so far.
std::uint64_t objCorner(const TextCursor& text, std::string_view word, std::size_t positions) {
  const std::int64_t number = text.parseInteger(word.substr(0, word.find('/')));
  const std::int64_t count = static_cast<std::int64_t>(positions);
  if (number == 0 || number < -count) {
    text.fail("a face names vertex " + std::to_string(number) + " of " + std::to_string(count));
  }
  return static_cast<std::uint64_t>(number > 0 ? number - 1 : count + number);
}

/// The counts of an .off file: on the line of the keyword or on the next.
struct OffCounts {
  std::uint64_t vertices = 0;
  std::uint64_t faces = 0;
};

OffCounts readOffHead(TextCursor& text) {
  if (!text.nextContentLine()) text.fail("it is not an .off file");
  const std::string_view keyword = text.nextWord();
  const bool known = keyword.size() >= 3 && keyword.substr(keyword.size() - 3) == "OFF" &&
                     keyword.find_first_not_of("STCNOF") == std::string_view::npos;
  if (!known) text.fail("it is not an .off file in three dimensions");
  std::string_view word = text.nextWord();
  if (sameWord(word, "BINARY")) text.fail("binary .off files are not supported");
  if (word.empty()) {
    if (!text.nextContentLine()) text.fail("the counts are missing");
    word = text.nextWord();
  }
  const std::int64_t vertices = text.parseInteger(word);
  const std::int64_t faces = text.nextInteger();
  // Each takes a line of its own.
  const std::int64_t most = static_cast<std::int64_t>(text.bytesLeft());
  if (vertices < 0 || faces < 0 || vertices > most || faces > most) {
    text.fail("it claims " + std::to_string(vertices) + " vertices and " + std::to_string(faces) +
              " faces, more than the file can hold");
  }
  return {static_cast<std::uint64_t>(vertices), static_cast<std::uint64_t>(faces)};
}

}  // namespace

Mesh readObj(const InputBytes& input) {
  TextCursor text(input, 0, 1);
  MeshBuilder builder;
  std::vector<std::uint64_t> corners;
  std::uint64_t largest = 0;
  std::size_t largestLine = 0;
  bool isObj = false;
  while (text.nextLine(/*continued=*/true)) {
    const std::string_view keyword = text.nextWord();
    isObj |= keyword == "o" || keyword == "g";
    if (keyword == "v") {
      builder.addPosition(nextPosition(text));
    } else if (keyword == "f") {
      corners.clear();
      for (auto word = text.nextWord(); !word.empty() && word[0] != '#'; word = text.nextWord()) {
        corners.push_back(objCorner(text, word, builder.mesh().positions.size()));
        if (largestLine != 0 && corners.back() <= largest) continue;
        largest = corners.back();
        largestLine = text.line();
      }
      // Faces may stand before the vertices that they name: those are counted at the end.
      builder.addFace(corners, std::numeric_limits<VertexIndex>::max(),
                      [&](const std::string& cause) { text.fail(cause); });
    }
  }
  const std::size_t count = builder.mesh().positions.size();
  if (largestLine != 0 && largest >= count) {
    input.failAtLine(largestLine, "a face names vertex " + std::to_string(largest + 1) + " of " +
                                      std::to_string(count));
  }
  // An object without any is an empty mesh.
  if (count == 0 && !isObj) input.fail("it holds no vertices");
  return std::move(builder.mesh());
}

Mesh readOff(const InputBytes& input) {
  TextCursor text(input, 0, 1);
  const OffCounts counts = readOffHead(text);
  MeshBuilder builder;
  builder.mesh().positions.reserve(counts.vertices);
  for (std::uint64_t n = 0; n < counts.vertices; ++n) {
    if (!text.nextContentLine())
      text.fail("the file ends after " + std::to_string(n) + " vertices");
    builder.addPosition(nextPosition(text));
  }
  std::vector<std::uint64_t> corners;
  for (std::uint64_t n = 0; n < counts.faces; ++n) {
    if (!text.nextContentLine()) text.fail("the file ends after " + std::to_string(n) + " faces");
    corners.clear();
    std::int64_t left = text.nextInteger();
    if (left < 0) text.fail("a face has " + std::to_string(left) + " vertices");
    for (; left > 0; --left) {
      const std::int64_t index = text.nextInteger();
      if (index < 0) text.fail("a face names vertex " + std::to_string(index));
      corners.push_back(static_cast<std::uint64_t>(index));
    }
    builder.addFace(corners, counts.vertices, [&](const std::string& cause) { text.fail(cause); });
  }
  return std::move(builder.mesh());
}

}  // namespace tufa::io
