#include "meta_image.h"

#include <tufa/error.h>
#include <fstream>
#include <string>

namespace tufa::bench {

openvdb::FloatGrid::Ptr readMetaImage(const std::filesystem::path& header) {
  std::ifstream text(header);
  openvdb::Coord size;
  openvdb::Vec3d spacing(1);
  std::string key, equals, data;
  while (text >> key >> equals) {
    if (key == "DimSize") {
      text >> size[0] >> size[1] >> size[2];
    } else if (key == "ElementSpacing") {
      text >> spacing[0] >> spacing[1] >> spacing[2];
    } else if (key == "ElementDataFile") {
      text >> data;
    } else {
      std::getline(text, data);
    }
  }
  std::ifstream samples(header.parent_path() / data, std::ios::binary);
  auto grid = openvdb::FloatGrid::create(0);
  openvdb::math::Mat4d scale = openvdb::math::Mat4d::identity();
  scale.preScale(spacing);
  grid->setTransform(openvdb::math::Transform::createLinearTransform(scale));
  auto accessor = grid->getAccessor();
  for (int z = 0; z < size[2]; ++z) {
    for (int y = 0; y < size[1]; ++y) {
      for (int x = 0; x < size[0]; ++x) {
        unsigned char bytes[2];
        samples.read(reinterpret_cast<char*>(bytes), 2);
        accessor.setValue({x, y, z}, static_cast<float>(bytes[0] | bytes[1] << 8));
      }
    }
  }
  if (!samples) throw Error(ErrorCode::UnreadableFile, data + ": too short");
  return grid;
}

}  // namespace tufa::bench
