#include "whole_image.h"

#include <zlib.h>

#include <tufa/error.h>
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string_view>
#include <vector>

#include "paths.h"

namespace tufa::tools {
namespace {

constexpr unsigned kPiece = 1U << 20;

[[noreturn]] void fail(const std::string& file, const std::string& why) {
  throw Error(ErrorCode::UnreadableFile, "cannot read " + file + ": " + why);
}
[[noreturn]] void failCut(const std::string& file) {
  fail(file, "it ends before the last of the values that it says it has");
}
[[noreturn]] void failPacked(const std::string& file, const std::string& why) {
  fail(file, "what it has packed is damaged or cut: zlib says: " + why);
}

/// A number at a place in bytes, in the order of bytes asked for.
template <class Number>
Number numberAt(const char* bytes, bool swapped) {
  std::array<char, sizeof(Number)> copy{};
  std::copy_n(bytes, copy.size(), copy.begin());
  if (swapped) std::reverse(copy.begin(), copy.end());
  Number number{};
  std::memcpy(&number, copy.data(), sizeof(Number));
  return number;
}

/// What a file holds once it is unpacked, if it is packed at all.
struct Unpacked {
  std::array<char, 112> head{};  ///< its first bytes
  double size = 0;
};

Unpacked unpack(const std::string& file) {
  // Files that are not packed it gives as they are.
  const std::unique_ptr<gzFile_s, int (*)(gzFile)> in(gzopen(file.c_str(), "rb"), gzclose_r);
  if (!in) fail(file, "it cannot be opened");
  Unpacked all;
  std::vector<char> piece(kPiece);
  int count = 0;
  while ((count = gzread(in.get(), piece.data(), kPiece)) > 0) {
    if (all.size == 0) std::copy_n(piece.begin(), std::min(count, 112), all.head.begin());
    all.size += count;
  }
  int error = Z_OK;
  const std::string why = gzerror(in.get(), &error);
  if (error != Z_OK && error != Z_STREAM_END) failPacked(file, why);
  return all;
}

/// The header and the values are in one file, or in two.
void requireWholeNifti(const std::string& header, const std::string& file, double bytes) {
  const Unpacked head = unpack(header);
  const double size = file == header ? head.size : unpack(file).size;
  constexpr std::int32_t kHeadBytes = 348;
  for (const bool swapped : {false, true}) {
    if (numberAt<std::int32_t>(head.head.data(), swapped) != kHeadBytes) continue;
    constexpr std::size_t kPlace = 108;
    if (numberAt<float>(head.head.data() + kPlace, swapped) + bytes > size) failCut(file);
  }
}

/// Of a header or values in a file of their own: x.hdr and x.img, packed or not.
void requireWholePair(const std::filesystem::path& file, double bytes) {
  std::filesystem::path stem = file;
  if (stem.extension() == ".gz") stem.replace_extension();
  const auto part = [&](const char* ending) -> std::string {
    for (const char* const packed : {"", ".gz"}) {
      std::filesystem::path path = stem;
      path.replace_extension(ending);
      path += packed;
      if (std::filesystem::exists(path)) return path.string();
    }
    return {};
  };
  const std::string header = part(".hdr");
  const std::string values = part(".img");
  if (!header.empty() && !values.empty()) requireWholeNifti(header, values, bytes);
}

/// Unpacks the rest of a stream, in the format of zlib or gzip.
void requirePacked(const std::string& file, std::istream& in, double bytes) {
  z_stream stream{};
  constexpr int kAnyHead = 32;
  if (inflateInit2(&stream, MAX_WBITS + kAnyHead) != Z_OK) fail(file, "zlib does not start");
  const std::unique_ptr<z_stream, int (*)(z_stream*)> end(&stream, inflateEnd);
  std::vector<Bytef> from(kPiece);
  std::vector<Bytef> to(kPiece);
  double size = 0;
  int state = Z_OK;
  while (state == Z_OK || state == Z_BUF_ERROR) {
    if (stream.avail_in == 0) {
      in.read(reinterpret_cast<char*>(from.data()), kPiece);
      stream.next_in = from.data();
      stream.avail_in = static_cast<uInt>(in.gcount());
      if (stream.avail_in == 0) failPacked(file, "unexpected end of file");
    }
    stream.next_out = to.data();
    stream.avail_out = kPiece;
    state = inflate(&stream, Z_NO_FLUSH);
    size += kPiece - stream.avail_out;
  }
  if (state != Z_STREAM_END) failPacked(file, stream.msg != nullptr ? stream.msg : "no data");
  if (size < bytes) failCut(file);
}

/// The head is lines of `key = value`; the last of them names the file of the values.
void requireWholeMetaImage(const std::string& file, double bytes) {
  std::ifstream in(file, std::ios::binary);
  bool packed = false;
  constexpr int kMostLines = 1000;
  std::string line;
  for (int n = 0; n < kMostLines && std::getline(in, line); ++n) {
    const auto equals = line.find('=');
    if (equals == std::string::npos) continue;
    const auto trimmed = [&](std::size_t from, std::size_t to) {
      const auto first = line.find_first_not_of(" \t\r", from);
      if (first == std::string::npos || first >= to) return std::string();
      const auto last = line.find_last_not_of(" \t\r", to - 1);
      return line.substr(first, last - first + 1);
    };
    const std::string key = trimmed(0, equals);
    const std::string value = trimmed(equals + 1, line.size());
    if (key == "CompressedData") packed = !value.empty() && (value[0] == 'T' || value[0] == 't');
    if (key != "ElementDataFile") continue;
    if (!packed) return;
    if (value == "LOCAL" || value == "local") return requirePacked(file, in, bytes);
    const std::filesystem::path other = std::filesystem::path(file).parent_path() / value;
    std::ifstream values(other, std::ios::binary);
    // A list or a pattern of files, of which ITK says what is missing.
    if (values) requirePacked(other.string(), values, bytes);
    return;
  }
}

/// The head is lines of `key: value` up to an empty one.
void requireWholeNrrd(const std::string& file, double bytes) {
  std::ifstream in(file, std::ios::binary);
  std::string line;
  std::string values;
  bool packed = false;
  constexpr int kMostLines = 1000;
  for (int n = 0; n < kMostLines && std::getline(in, line); ++n) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (line.empty()) break;
    const auto valueOf = [&](const std::string& key) {
      return line.rfind(key + ": ", 0) == 0 ? line.substr(key.size() + 2) : std::string();
    };
    if (const std::string coding = valueOf("encoding"); coding == "gzip" || coding == "gz") {
      packed = true;
    }
    for (const char* const key : {"data file", "datafile"}) {
      if (const std::string name = valueOf(key); !name.empty()) values = name;
    }
    // Something before the packed values is left out first.
    if (line.rfind("line skip", 0) == 0 || line.rfind("byte skip", 0) == 0) return;
  }
  if (!packed) return;
  if (values.empty()) return requirePacked(file, in, bytes);
  const std::filesystem::path other = std::filesystem::path(file).parent_path() / values;
  std::ifstream apart(other, std::ios::binary);
  // A list or a pattern of files, of which ITK says what is missing.
  if (apart) requirePacked(other.string(), apart, bytes);
}

/// Where the values of a DICOM file lie, as the element that holds them says.
class DicomValues {
 public:
  DicomValues(const std::string& file, double values) : file_(file), values_(values) {}

  /// ITK takes values that are missing for 0.
  void requireWhole() const {
    std::ifstream in(file_, std::ios::binary);
    constexpr std::streamoff kMark = 128;
    std::array<char, 4> mark{};
    in.seekg(kMark);
    in.read(mark.data(), mark.size());
    if (!in || std::string_view(mark.data(), mark.size()) != "DICM") return;
    const auto size = static_cast<std::uint64_t>(std::filesystem::file_size(file_));
    std::string bytes;
    std::uint64_t begin = kMark + 4;
    bool claimed = false;
    while (in) {
      const std::size_t kept = bytes.size();
      bytes.resize(kept + kPiece);
      in.read(bytes.data() + kept, kPiece);
      bytes.resize(kept + static_cast<std::size_t>(in.gcount()));
      const Element found = lookIn(bytes, begin, size);
      if (found == Element::Whole) return;
      claimed = claimed || found == Element::Cut;
      // An element may lie across the end.
      const std::size_t left = std::min<std::size_t>(bytes.size(), kHead - 1);
      begin += bytes.size() - left;
      bytes.erase(0, bytes.size() - left);
    }
    if (claimed) failCut(file_);
  }

 private:
  enum class Element { None, Cut, Whole };
  static constexpr std::size_t kHead = 12;  ///< bytes of the longest head of an element

  /// An element of as many bytes as the values take, at one bit each: that of an icon is shorter.
  /// Those that are packed have no length.
  [[nodiscard]] Element lookIn(std::string_view bytes, std::uint64_t begin,
                               std::uint64_t size) const {
    constexpr std::string_view kTag("\xe0\x7f\x10\0", 4);
    Element found = Element::None;
    for (auto at = bytes.find(kTag); at != std::string_view::npos; at = bytes.find(kTag, at + 1)) {
      if (bytes.size() - at < kHead) break;
      const std::string_view type = bytes.substr(at + 4, 2);
      const bool typed = type == "OW" || type == "OB";
      const auto length = numberAt<std::uint32_t>(bytes.data() + at + (typed ? 8 : 4), false);
      constexpr std::uint32_t kNone = 0xffffffff;
      if (length == kNone || length < values_ / 8) continue;
      if (begin + at + (typed ? kHead : 8) + length <= size) return Element::Whole;
      found = Element::Cut;
    }
    return found;
  }

  std::string file_;
  double values_;
};

/// ITK leaves out the pages that come after the first place where the file is cut.
void requireWholeTiff(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  const auto size = static_cast<std::uint64_t>(std::filesystem::file_size(file));
  std::array<char, 16> head{};
  in.read(head.data(), head.size());
  const bool swapped = head[0] == 'M';  // this machine's numbers begin with the low byte
  const bool big = numberAt<std::uint16_t>(head.data() + 2, swapped) == 43;
  const auto offsetIn = [&](const char* bytes) {
    return big ? numberAt<std::uint64_t>(bytes, swapped)
               : std::uint64_t{numberAt<std::uint32_t>(bytes, swapped)};
  };
  const std::uint64_t countBytes = big ? 8 : 2;
  const std::uint64_t entryBytes = big ? 20 : 12;
  const std::uint64_t offsetBytes = big ? 8 : 4;
  std::uint64_t page = offsetIn(head.data() + (big ? 8 : 4));
  // A page takes room: more of them than there is are a circle, which ITK does not follow either.
  for (std::uint64_t n = 0; page != 0 && n < size / (countBytes + offsetBytes); ++n) {
    std::array<char, 8> bytes{};
    const auto read = [&](std::uint64_t place, std::uint64_t count) {
      if (place > size || count > size - place) failCut(file);
      in.seekg(static_cast<std::streamoff>(place));
      in.read(bytes.data(), static_cast<std::streamsize>(count));
    };
    read(page, countBytes);
    const std::uint64_t entries = big ? numberAt<std::uint64_t>(bytes.data(), swapped)
                                      : numberAt<std::uint16_t>(bytes.data(), swapped);
    if (entries > size / entryBytes) failCut(file);
    read(page + countBytes + entries * entryBytes, offsetBytes);
    page = offsetIn(bytes.data());
  }
}

}  // namespace

void requireWholeImage(const std::string& file, double values, double bytesOfEach) {
  const double bytes = values * bytesOfEach;
  std::string ending = endingOf(file);
  if (ending == ".gz") ending = endingOf(file.substr(0, file.size() - 3)) + ending;
  if (ending == ".hdr" || ending == ".img" || ending == ".hdr.gz" || ending == ".img.gz") {
    requireWholePair(file, bytes);
  } else if (ending == ".nii" || ending == ".nii.gz") {
    requireWholeNifti(file, file, bytes);
  } else if (ending == ".mha" || ending == ".mhd") {
    requireWholeMetaImage(file, bytes);
  } else if (ending == ".nrrd" || ending == ".nhdr") {
    requireWholeNrrd(file, bytes);
  } else if (ending == ".tif" || ending == ".tiff") {
    requireWholeTiff(file);
  } else {
    DicomValues(file, values).requireWhole();
  }
}

}  // namespace tufa::tools
