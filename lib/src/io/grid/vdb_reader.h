#pragma once

#include <openvdb/io/Archive.h>
#include <openvdb/io/GridDescriptor.h>
#include <openvdb/io/io.h>
#include <openvdb/openvdb.h>

#include <tufa/memory.h>
#include <filesystem>
#include <functional>
#include <istream>
#include <memory>
#include <streambuf>
#include <string>
#include <unordered_map>
#include <vector>

namespace tufa::io {

/// Reads grids of a .vdb file one by one, and of a .nvdb file all at once. Used in place of
/// openvdb::io::File because that class does not look at its stream's state: a truncated file then
/// gives grids of whatever was in memory. Here every failed read throws. All members throw
/// Error(UnreadableFile).
class VdbReader : private openvdb::io::Archive {
 public:
  explicit VdbReader(const std::filesystem::path& path);
  /// Of bytes that outlive it.
  explicit VdbReader(const FileBytes& file);

  /// Of the file, for messages.
  [[nodiscard]] const std::string& name() const { return name_; }

  [[nodiscard]] std::size_t gridCount() const { return entries_.size(); }

  /// The grid's name; grids of the same name are distinguished as "name[0]", "name[1]" and so on.
  [[nodiscard]] std::string gridName(std::size_t index) const;
  [[nodiscard]] bool isNamed(std::size_t index, const std::string& name) const;

  /// An empty grid with the metadata and the transform.
  [[nodiscard]] openvdb::GridBase::Ptr readOutline(std::size_t index);

  /// The grid with all its values; of points only the tree, without what its leaves hold.
  [[nodiscard]] openvdb::GridBase::Ptr readGrid(std::size_t index);

  /// A grid whose leaves have no values, and where in the file these are.
  struct Topology {
    openvdb::GridBase::Ptr grid;
    std::vector<std::uint64_t> leafPlaces;  ///< in the order of the tree
  };

  /// The grid without values. Null where leaves are not read one by one: in a .nvdb, files without
  /// offsets or of before 2013, grids that are neither of float nor of double or have their tree
  /// from another one.
  [[nodiscard]] Topology readTopology(std::size_t index);

  /// Calls read(stream, whether values are in half precision) with the stream at a leaf's buffers.
  /// `grid` is that of the last call of readTopology(), no other grid having been read since.
  void readAt(std::uint64_t place, const openvdb::GridBase& grid,
              const std::function<void(std::istream&, bool)>& read);

 private:
  struct Entry {
    openvdb::io::GridDescriptor descriptor;
    openvdb::GridBase::Ptr whole;  ///< set for .nvdb and files without offsets, read in one go
  };

  void openFile(const std::filesystem::path& path);
  void begin(std::unique_ptr<std::streambuf> buffer);
  /// Whether it is a file of NanoVDB; any but that and OpenVDB's are refused.
  bool readMagic();
  void readNano();
  void readHead();
  void requireKnownVersion();
  void readSequentially(std::size_t index);
  void requireInside(const openvdb::io::GridDescriptor& descriptor) const;
  void requireApart() const;

  // OpenVDB makes room for whatever length or count a file claims, and reads over the end of room
  // that is too small. These look ahead, fail where what is claimed cannot be so, and leave the
  // stream where it was.
  void requireSoundFileMetadata();
  void requireSoundDescriptor();
  void requireSoundGridHead();
  /// Returns where the leaves' buffers are.
  std::vector<std::uint64_t> requireSoundTree(const openvdb::io::GridDescriptor& descriptor);

  [[nodiscard]] std::uint64_t bytesLeft();
  std::uint32_t takeNumber();
  std::string takeText();
  void takeMetadata();
  void takeMap(bool mayBeFrustum);
  openvdb::GridBase::Ptr readTree(const openvdb::io::GridDescriptor& descriptor);
  void readHere(const openvdb::GridBase::Ptr& grid, const openvdb::io::GridDescriptor& descriptor);
  void readPoints(openvdb::GridBase& grid);
  void readTopologyHere(openvdb::GridBase& grid);
  void guarded(const std::string& what, const std::function<void()>& work) const;
  [[noreturn]] void fail(const std::string& cause) const;

  std::string name_;
  openvdb::SharedPtr<openvdb::io::StreamMetadata> streamMetadata_;  ///< stream_ keeps its address
  std::unique_ptr<std::streambuf> buffer_;
  std::istream stream_{nullptr};
  std::uint64_t fileBytes_ = 0;
  std::vector<Entry> entries_;
  std::unordered_map<std::string, std::size_t> timesNamed_;  ///< how many grids have a name
};

}  // namespace tufa::io
