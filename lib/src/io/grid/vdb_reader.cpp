#include "io/grid/vdb_reader.h"

#include <tufa/error.h>
#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <new>
#include <utility>

#include "io/grid/head_checks.h"
#include "io/grid/nanovdb.h"
#include "io/grid/tree_walker.h"
#include "io/input_bytes.h"
#include "io/memory_buffer.h"

namespace tufa::io {

using openvdb::GridBase;
using openvdb::io::GridDescriptor;

namespace {

constexpr std::size_t kMagicBytes = 8;

GridBase::Ptr createGrid(const GridDescriptor& descriptor) {
  GridBase::Ptr grid = GridBase::createGrid(descriptor.gridType());
  grid->setSaveFloatAsHalf(descriptor.saveFloatAsHalf());  // tells readers of values their width
  return grid;
}

}  // namespace

VdbReader::VdbReader(const std::filesystem::path& path) : name_(path.string()) { openFile(path); }

VdbReader::VdbReader(const FileBytes& file) : name_(file.name), fileBytes_(file.bytes.size()) {
  begin(std::make_unique<MemoryBuffer>(file.bytes));
}

void VdbReader::begin(std::unique_ptr<std::streambuf> buffer) {
  buffer_ = std::move(buffer);
  stream_.rdbuf(buffer_.get());
  openvdb::initialize();
  if (readMagic()) {
    guarded("a grid", [this] { readNano(); });
    return;
  }
  guarded("the header", [this] { readHead(); });
}

void VdbReader::fail(const std::string& cause) const {
  throw Error(ErrorCode::UnreadableFile, "cannot read " + name_ + ": " + cause);
}

void VdbReader::guarded(const std::string& what, const std::function<void()>& work) const {
  try {
    work();
  } catch (const Error&) {
    throw;
  } catch (const std::ios_base::failure&) {
    fail("the file ends inside " + what + ", it is truncated or damaged");
  } catch (const DamagedGrid& damage) {
    fail(what + " is damaged: " + damage.what());
  } catch (const std::length_error&) {
    fail(what + " is damaged");
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    std::string message = error.what();
    std::replace(message.begin(), message.end(), '\n', ' ');
    fail("OpenVDB says of " + what + ": " + message);
  }
}

void VdbReader::openFile(const std::filesystem::path& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (status.type() == std::filesystem::file_type::not_found) fail(std::strerror(ENOENT));
  if (error) fail(error.message());
  if (std::filesystem::is_directory(status)) fail("it is a folder");
  if (!std::filesystem::is_regular_file(status)) fail("it is not a regular file");
  auto file = std::make_unique<std::filebuf>();
  if (file->open(path, std::ios_base::in | std::ios_base::binary) == nullptr) {
    fail(std::strerror(errno));
  }
  fileBytes_ = std::filesystem::file_size(path, error);
  begin(std::move(file));
}

bool VdbReader::readMagic() {
  const std::array<char, kMagicBytes> vdb{' ', 'B', 'D', 'V', 0, 0, 0, 0};
  std::array<char, kMagicBytes> magic{};
  stream_.read(magic.data(), kMagicBytes);
  if (stream_.gcount() == 0) fail("the file is empty");
  const bool isNano = std::string_view(magic.data(), kMagicBytes).starts_with("NanoVDB");
  if (magic != vdb && !isNano) fail("it is not an OpenVDB file");
  stream_.clear();
  stream_.seekg(0);
  stream_.exceptions(std::ios_base::failbit | std::ios_base::badbit | std::ios_base::eofbit);
  return isNano;
}

void VdbReader::readNano() {
  std::string bytes;
  if (hasNanoVdb()) {
    if (!fitsMemory(fileBytes_)) {
      fail("its " + std::to_string(fileBytes_) + " bytes do not fit into memory");
    }
    bytes.resize(fileBytes_);
    stream_.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  }
  for (const GridBase::Ptr& grid : readNanoVdb(bytes, [this](const auto& why) { fail(why); })) {
    const std::size_t before = timesNamed_[grid->getName()]++;
    const std::string unique = GridDescriptor::addSuffix(grid->getName(), static_cast<int>(before));
    entries_.push_back({GridDescriptor(unique, grid->type()), grid});
  }
}

void VdbReader::readHead() {
  streamMetadata_.reset(new openvdb::io::StreamMetadata);
  openvdb::io::setStreamMetadataPtr(stream_, streamMetadata_);
  requireKnownVersion();
  readHeader(stream_);
  setFormatVersion(stream_);
  setLibraryVersion(stream_);
  setDataCompression(stream_);
  requireSoundFileMetadata();
  openvdb::MetaMap fileMetadata;
  fileMetadata.readMeta(stream_);

  const std::int32_t count = readGridCount(stream_);
  if (count < 0) fail("it claims to hold " + std::to_string(count) + " grids");
  for (std::int32_t n = 0; n < count; ++n) {
    Entry& entry = entries_.emplace_back();
    requireSoundDescriptor();
    entry.whole = entry.descriptor.read(stream_);
    ++timesNamed_[entry.descriptor.gridName()];
    if (inputHasGridOffsets()) {
      entry.whole.reset();
      requireInside(entry.descriptor);
      entry.descriptor.seekToEnd(stream_);
    } else {
      readSequentially(entries_.size() - 1);
    }
  }
  if (inputHasGridOffsets()) requireApart();
}

/// OpenVDB goes on with a version that it does not know, after a warning on standard output or
/// error.
void VdbReader::requireKnownVersion() {
  stream_.seekg(kMagicBytes);
  const std::uint32_t version = takeNumber();
  stream_.seekg(0);
  const std::string format = "its format is version " + std::to_string(version);
  if (version < kOldestFormat) fail(format + ", older than OpenVDB 1.0");
  if (version > openvdb::OPENVDB_FILE_VERSION) {
    fail(format + ", newer than the " + std::to_string(openvdb::OPENVDB_FILE_VERSION) +
         " that OpenVDB " + openvdb::getLibraryVersionString() +
         " knows: write it with an older OpenVDB, or it is damaged");
  }
}

/// Many that share their bytes would make the work of many files from one.
void VdbReader::requireApart() const {
  std::vector<std::pair<std::int64_t, std::int64_t>> stretches;
  for (const Entry& entry : entries_) {
    stretches.emplace_back(entry.descriptor.getGridPos(), entry.descriptor.getEndPos());
  }
  std::sort(stretches.begin(), stretches.end());
  for (std::size_t n = 1; n < stretches.size(); ++n) {
    const auto& [begin, end] = stretches[n - 1];
    if (stretches[n].first < std::max(end, begin + 1)) {
      fail("two of its grids lie at byte " + std::to_string(stretches[n].first) + ": damaged");
    }
  }
}

void VdbReader::readSequentially(std::size_t index) {
  Entry& entry = entries_[index];
  readHere(entry.whole, entry.descriptor);
  if (!entry.descriptor.isInstance()) return;
  const auto parent = std::find_if(entries_.begin(), entries_.end() - 1, [&](const Entry& other) {
    return other.descriptor.uniqueName() == entry.descriptor.instanceParentName();
  });
  if (parent == entries_.end() - 1) fail("a grid shares the tree of a grid that is missing");
  entry.whole->setTree(parent->whole->baseTreePtr());
}

void VdbReader::requireInside(const GridDescriptor& descriptor) const {
  const auto inside = [&](std::int64_t position) {
    return position >= 0 && static_cast<std::uint64_t>(position) <= fileBytes_;
  };
  if (!inside(descriptor.getGridPos()) || !inside(descriptor.getEndPos())) {
    fail("the file has " + std::to_string(fileBytes_) + " bytes, grid \"" + descriptor.gridName() +
         "\" reaches to byte " + std::to_string(descriptor.getEndPos()) + ": truncated or damaged");
  }
}

std::uint64_t VdbReader::bytesLeft() {
  return fileBytes_ - std::min(fileBytes_, static_cast<std::uint64_t>(stream_.tellg()));
}

std::uint32_t VdbReader::takeNumber() {
  std::uint32_t number = 0;
  stream_.read(reinterpret_cast<char*>(&number), sizeof number);
  return number;
}

std::string VdbReader::takeText() {
  const std::uint32_t length = takeNumber();
  if (length > bytesLeft()) {
    fail("it claims a text of " + std::to_string(length) + " bytes where " +
         std::to_string(bytesLeft()) + " are left: truncated or damaged");
  }
  std::string text(length, '\0');
  stream_.read(text.data(), length);
  return text;
}

void VdbReader::takeMetadata() {
  const std::uint32_t count = takeNumber();
  for (std::uint32_t n = 0; n < count; ++n) {
    takeText();  // the name
    const std::string type = takeText();
    requireSoundMetadata(type, takeText(), fileBytes_);
  }
}

/// A frustum holds a second map, in which OpenVDB would look for a third and so on.
void VdbReader::takeMap(bool mayBeFrustum) {
  const std::string map = takeText();
  if (map != openvdb::math::NonlinearFrustumMap::mapType()) return;
  if (!mayBeFrustum) fail("it has a frustum within a frustum: damaged");
  const bool realBox = fileVersion() >= openvdb::OPENVDB_FILE_VERSION_FLOAT_FRUSTUM_BBOX;
  const std::size_t boxBytes = 6 * (realBox ? sizeof(double) : sizeof(std::int32_t));
  constexpr std::size_t kTaperDepthBytes = 2 * sizeof(double);
  stream_.seekg(static_cast<std::streamoff>(boxBytes + kTaperDepthBytes), std::ios_base::cur);
  takeMap(false);
}

void VdbReader::requireSoundFileMetadata() {
  const auto start = stream_.tellg();
  takeMetadata();
  stream_.seekg(start);
}

void VdbReader::requireSoundDescriptor() {
  const auto start = stream_.tellg();
  takeText();  // the grid's name
  takeText();  // its type
  takeText();  // its parent
  stream_.seekg(start);
}

void VdbReader::requireSoundGridHead() {
  const auto start = stream_.tellg();
  if (fileVersion() >= openvdb::OPENVDB_FILE_VERSION_NODE_MASK_COMPRESSION) takeNumber();
  takeMetadata();
  takeMap(true);
  stream_.seekg(start);
}

/// Behind a head that is sound.
std::vector<std::uint64_t> VdbReader::requireSoundTree(const GridDescriptor& descriptor) {
  if (descriptor.isInstance()) return {};
  const auto start = stream_.tellg();
  const GridBase::Ptr head = createGrid(descriptor);
  readGridCompression(stream_);
  head->readMeta(stream_);
  head->readTransform(stream_);
  const auto layout = layoutOf(*head);
  if (!layout) {
    fail("the sizes in grids of type " + descriptor.gridType() +
         " cannot be checked, as in grid \"" + descriptor.gridName() + "\"");
  }
  // Programs that write a single grid may leave its end out.
  const bool ends = inputHasGridOffsets() && descriptor.getEndPos() > descriptor.getGridPos();
  const std::uint64_t end = ends ? static_cast<std::uint64_t>(descriptor.getEndPos()) : fileBytes_;
  // The metadata, not the descriptor, says whether values are in half precision.
  const TreeCoding coding{fileVersion(), openvdb::io::getDataCompression(stream_),
                          head->saveFloatAsHalf()};
  TreeWalker walker(stream_, end, *layout, coding);
  walker.walk();
  stream_.seekg(start);
  return walker.takeLeafPlaces();
}

std::string VdbReader::gridName(std::size_t index) const {
  const GridDescriptor& descriptor = entries_.at(index).descriptor;
  return timesNamed_.at(descriptor.gridName()) == 1
             ? descriptor.gridName()
             : GridDescriptor::nameAsString(descriptor.uniqueName());
}

bool VdbReader::isNamed(std::size_t index, const std::string& name) const {
  return entries_.at(index).descriptor.gridName() == name || gridName(index) == name;
}

GridBase::Ptr VdbReader::readOutline(std::size_t index) {
  const Entry& entry = entries_.at(index);
  if (entry.whole) return entry.whole;
  GridBase::Ptr grid;
  guarded("grid \"" + gridName(index) + "\"", [&] {
    grid = createGrid(entry.descriptor);
    entry.descriptor.seekToGrid(stream_);
    requireSoundGridHead();
    readGridCompression(stream_);
    grid->readMeta(stream_);
    grid->readTransform(stream_);
  });
  grid->setName(entry.descriptor.gridName());
  return grid;
}

GridBase::Ptr VdbReader::readTree(const GridDescriptor& descriptor) {
  GridBase::Ptr grid = createGrid(descriptor);
  descriptor.seekToGrid(stream_);
  readHere(grid, descriptor);
  return grid;
}

void VdbReader::readHere(const GridBase::Ptr& grid, const GridDescriptor& descriptor) {
  requireSoundGridHead();
  requireSoundTree(descriptor);
  const auto layout = layoutOf(*grid);
  if (layout && layout->leaf == TreeLayout::Leaf::Points && !descriptor.isInstance()) {
    readPoints(*grid);
  } else {
    Archive::readGrid(grid, descriptor, stream_);
  }
}

/// What leaves of points hold is pages of attributes, whose sizes OpenVDB trusts too. Points cannot
/// be meshed: they are not read.
void VdbReader::readPoints(GridBase& grid) {
  if (!inputHasGridOffsets()) fail("it has points, and does not say where they end");
  readTopologyHere(grid);
  openvdb::io::setGridBackgroundValuePtr(stream_, nullptr);  // it is that of the root just read
}

void VdbReader::readTopologyHere(GridBase& grid) {
  readGridCompression(stream_);
  grid.readMeta(stream_);
  grid.removeMeta(GridBase::META_FILE_DELAYED_LOAD);
  grid.readTransform(stream_);
  grid.readTopology(stream_);
}

GridBase::Ptr VdbReader::readGrid(std::size_t index) {
  const Entry& entry = entries_.at(index);
  if (entry.whole) return entry.whole;
  GridBase::Ptr grid;
  guarded("grid \"" + gridName(index) + "\"", [&] {
    grid = readTree(entry.descriptor);
    if (!entry.descriptor.isInstance()) return;
    const auto parent = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& other) {
      return other.descriptor.uniqueName() == entry.descriptor.instanceParentName();
    });
    if (parent == entries_.end()) fail("a grid shares the tree of a grid that is missing");
    grid->setTree(readTree(parent->descriptor)->baseTreePtr());
  });
  return grid;
}

VdbReader::Topology VdbReader::readTopology(std::size_t index) {
  const Entry& entry = entries_.at(index);
  if (entry.whole || entry.descriptor.isInstance() ||
      fileVersion() < openvdb::OPENVDB_FILE_VERSION_NODE_MASK_COMPRESSION) {
    return {};
  }
  Topology topology;
  guarded("grid \"" + gridName(index) + "\"", [&] {
    const GridBase::Ptr grid = createGrid(entry.descriptor);
    if (!grid->isType<openvdb::FloatGrid>() && !grid->isType<openvdb::DoubleGrid>()) return;
    entry.descriptor.seekToGrid(stream_);
    requireSoundGridHead();
    topology.leafPlaces = requireSoundTree(entry.descriptor);
    readTopologyHere(*grid);
    if (grid->baseTree().leafCount() != topology.leafPlaces.size()) fail("it is damaged");
    topology.grid = grid;
  });
  return topology;
}

void VdbReader::readAt(std::uint64_t place, const GridBase& grid,
                       const std::function<void(std::istream&, bool)>& read) {
  guarded("grid \"" + grid.getName() + "\"", [&] {
    // Seeking empties the stream's buffer.
    if (static_cast<std::uint64_t>(stream_.tellg()) != place) {
      stream_.seekg(static_cast<std::streamoff>(place));
    }
    read(stream_, grid.saveFloatAsHalf());
  });
}

}  // namespace tufa::io
