// Images through ITK.
#include <itkGDCMImageIO.h>
#include <itkGDCMSeriesFileNames.h>
#include <itkImageIOBase.h>
#include <itkMetaImageIO.h>
#include <itkNiftiImageIO.h>
#include <itkNrrdImageIO.h>
#include <itkPNGImageIO.h>
#include <itkTIFFImageIO.h>

#include <tufa/error.h>
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <utility>

#include "console.h"
#include "crash_guard.h"
#include "image_reader.h"
#include "paths.h"
#include "whole_image.h"

namespace tufa::tools {
namespace {

using ImageIo = itk::ImageIOBase;

[[noreturn]] void fail(const std::string& file, const std::string& why) {
  throw Error(ErrorCode::UnreadableFile, "cannot read " + file + ": " + why);
}

/// Calls work(), which reads a file by ITK; its errors become ours.
template <class Work>
auto guarded(const std::string& file, const Work& work) {
  const CrashGuard guard(file);
  try {
    return work();
  } catch (const itk::ExceptionObject& error) {
    // "ITK ERROR: MetaImageIO(0x55...): what is wrong.", and further lines.
    std::string text = error.GetDescription();
    if (const auto end = text.find("): "); end != std::string::npos) text.erase(0, end + 3);
    // What is wrong comes last, after what was being done.
    while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back())) != 0) {
      text.pop_back();
    }
    const std::string first = text.substr(0, text.find('\n'));
    const std::string last = text.substr(text.rfind('\n') + 1);
    text = first.ends_with(':') ? first + ' ' + last : first;
    fail(file, "ITK says: " + (text.empty() ? "no image" : text));
  }
}

/// What reads a file, which has told its size, or nothing.
ImageIo::Pointer readerOf(const std::string& file) {
  if (!std::filesystem::is_regular_file(file)) fail(file, "there is no such file");
  return guarded(file, [&] {
    const std::array<ImageIo::Pointer, 6> all = {
        ImageIo::Pointer(itk::GDCMImageIO::New()), ImageIo::Pointer(itk::MetaImageIO::New()),
        ImageIo::Pointer(itk::NrrdImageIO::New()), ImageIo::Pointer(itk::NiftiImageIO::New()),
        ImageIo::Pointer(itk::TIFFImageIO::New()), ImageIo::Pointer(itk::PNGImageIO::New())};
    for (const ImageIo::Pointer& io : all) {
      if (!io->CanReadFile(file.c_str())) continue;
      io->SetFileName(file);
      io->ReadImageInformation();
      return io;
    }
    fail(file,
         "it is no image in DICOM, MetaImage, NRRD, NIfTI, TIFF or PNG; raw values need "
         "--size");
  });
}

/// The image in one file: its place and its values.
class ImageFile {
 public:
  explicit ImageFile(const std::string& file) : file_(file), io_(readerOf(file)) {
    if (io_->GetNumberOfComponents() != 1) {
      fail(file, "it has " + std::to_string(io_->GetNumberOfComponents()) +
                     " values for each voxel, such as a colour; one is needed");
    }
    requireWholeImage(file, static_cast<double>(io_->GetImageSizeInComponents()),
                      static_cast<double>(io_->GetComponentSize()));
    dimensions_ = io_->GetNumberOfDimensions();
    for (unsigned n = 3; n < dimensions_; ++n) {
      if (io_->GetDimensions(n) != 1) fail(file, "it has more than three dimensions");
    }
    for (unsigned n = 0; n < std::min(dimensions_, 3U); ++n) {
      size_[n] = static_cast<std::int64_t>(io_->GetDimensions(n));
    }
  }

  [[nodiscard]] const std::array<std::int64_t, 3>& size() const { return size_; }

  /// From a voxel to the next along an axis.
  [[nodiscard]] Position step(unsigned axis) const {
    std::array<double, 3> step{};
    step[axis] = 1;
    if (axis >= dimensions_) return {step[0], step[1], step[2]};
    const std::vector<double> direction = io_->GetDirection(axis);
    for (unsigned n = 0; n < 3; ++n) {
      step[n] = n < direction.size() ? direction[n] * io_->GetSpacing(axis) : 0;
    }
    return {step[0], step[1], step[2]};
  }
  [[nodiscard]] Position origin() const {
    std::array<double, 3> at{};
    for (unsigned n = 0; n < std::min(dimensions_, 3U); ++n) at[n] = io_->GetOrigin(n);
    return {at[0], at[1], at[2]};
  }
  /// Whether the file says where it lies.
  [[nodiscard]] bool hasPlace() const { return dimensions_ >= 3; }

  /// Throws Error unless the file holds the last of the values that it claims: before memory is
  /// filled with slices that are not there.
  void requireWhole() { load(size_[2] - 1, 1); }

  /// Slices [first, first + count) to `values`.
  void read(std::int64_t first, std::int64_t count, float* values) {
    const auto area = static_cast<std::size_t>(size_[0] * size_[1]);
    load(first, count);
    const std::size_t skipped = inParts() ? 0 : area * static_cast<std::size_t>(first);
    toFloats(bytes_.get() + skipped * io_->GetComponentSize(),
             area * static_cast<std::size_t>(count), values);
  }

 private:
  [[nodiscard]] bool inParts() const { return size_[2] > 1 && io_->CanStreamRead(); }

  /// Reads some slices; all of them, and only once, where the format has no parts.
  void load(std::int64_t first, std::int64_t count) {
    if (!inParts() && bytes_) return;
    itk::ImageIORegion region(dimensions_);
    for (unsigned n = 0; n < dimensions_; ++n) region.SetSize(n, io_->GetDimensions(n));
    if (inParts()) {
      region.SetIndex(2, first);
      region.SetSize(2, static_cast<itk::ImageIORegion::SizeValueType>(count));
    }
    io_->SetIORegion(region);
    const auto slices = static_cast<std::size_t>(inParts() ? count : size_[2]);
    const std::size_t width = io_->GetComponentSize();
    const std::size_t size = static_cast<std::size_t>(size_[0] * size_[1]) * slices * width;
    bytes_ = std::make_unique_for_overwrite<char[]>(size);
    // ITK does not say of all formats that a file ends early: what it leaves in the last value
    // tells.
    std::vector<bool> left(width, true);
    for (const char mark : {'\x5a', '\xa5'}) {
      char* const last = bytes_.get() + size - width;
      std::fill_n(last, width, mark);
      guarded(file_, [&] { io_->Read(bytes_.get()); });
      for (std::size_t n = 0; n < width; ++n) left[n] = left[n] && last[n] == mark;
      if (std::find(left.begin(), left.end(), true) == left.end()) return;
    }
    fail(file_, "it ends before the last of the values that it says it has");
  }

  template <class Value>
  static void convert(const char* bytes, std::size_t count, float* values) {
    // new gives memory that is aligned as any type needs.
    const auto* const from = reinterpret_cast<const Value*>(bytes);
    for (std::size_t n = 0; n < count; ++n) values[n] = static_cast<float>(from[n]);
  }
  void toFloats(const char* bytes, std::size_t count, float* values) const {
    using Component = itk::IOComponentEnum;
    switch (io_->GetComponentType()) {
      case Component::UCHAR:
        return convert<unsigned char>(bytes, count, values);
      case Component::CHAR:
        return convert<signed char>(bytes, count, values);
      case Component::USHORT:
        return convert<unsigned short>(bytes, count, values);
      case Component::SHORT:
        return convert<short>(bytes, count, values);
      case Component::UINT:
        return convert<unsigned int>(bytes, count, values);
      case Component::INT:
        return convert<int>(bytes, count, values);
      case Component::ULONG:
        return convert<unsigned long>(bytes, count, values);
      case Component::LONG:
        return convert<long>(bytes, count, values);
      case Component::FLOAT:
        return convert<float>(bytes, count, values);
      case Component::DOUBLE:
        return convert<double>(bytes, count, values);
      default:
        fail(file_, "its values are " + ImageIo::GetComponentTypeAsString(io_->GetComponentType()));
    }
  }

  std::string file_;
  ImageIo::Pointer io_;
  unsigned dimensions_ = 0;
  std::array<std::int64_t, 3> size_{1, 1, 1};
  std::unique_ptr<char[]> bytes_;  ///< what was read last: all of it, where the format has no parts
};

/// The files of a DICOM series in a folder, in the order of their places.
std::vector<std::string> filesOfSeries(const std::string& folder,
                                       const std::optional<std::string>& series) {
  return guarded(folder, [&] {
    const auto names = itk::GDCMSeriesFileNames::New();
    names->SetUseSeriesDetails(true);
    names->SetDirectory(folder);
    const std::vector<std::string> all = names->GetSeriesUIDs();
    if (all.empty()) fail(folder, "there is no DICOM series in the folder");
    if (!series && all.size() > 1) {
      std::string list;
      for (const std::string& uid : all) list += (list.empty() ? "" : ", ") + uid;
      throw Error(ErrorCode::InvalidArgument, folder + " holds " + std::to_string(all.size()) +
                                                  " DICOM series; choose one by --series: " + list);
    }
    const std::string uid = series.value_or(all.front());
    if (std::find(all.begin(), all.end(), uid) == all.end()) {
      fail(folder, "there is no DICOM series " + uid);
    }
    return names->GetFileNames(uid);
  });
}

double lengthOf(const Position& p) { return std::hypot(p.x, p.y, p.z); }
Position minus(const Position& a, const Position& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }

/// A stack of files, each a slice: its step is that between the first and the last.
ImageSlices openStack(const std::vector<std::string>& files) {
  ImageSlices image;
  std::vector<Position> origins;
  bool placed = true;
  for (const std::string& file : files) {
    ImageFile slice(file);
    if (origins.empty()) {
      slice.requireWhole();
      image.size = slice.size();
      for (unsigned axis = 0; axis < 3; ++axis) image.steps[axis] = slice.step(axis);
      image.origin = slice.origin();
    }
    if (slice.size()[0] != image.size[0] || slice.size()[1] != image.size[1] ||
        slice.size()[2] != 1) {
      fail(file, "a stack needs slices of one size, which the first file gives");
    }
    placed = placed && slice.hasPlace();
    origins.push_back(slice.origin());
  }
  image.size[2] = static_cast<std::int64_t>(files.size());
  const double last = static_cast<double>(files.size() - 1);
  const Position between = minus(origins.back(), origins.front());
  if (placed && lengthOf(between) > 0) {
    image.steps[2] = {between.x / last, between.y / last, between.z / last};
    // A slice that is missing would shift all that follow.
    constexpr double kMost = 0.1;
    for (std::size_t n = 0; n < files.size(); ++n) {
      const double share = static_cast<double>(n) / last;
      const Position due(origins[0].x + between.x * share, origins[0].y + between.y * share,
                         origins[0].z + between.z * share);
      const double off = lengthOf(minus(origins[n], due)) / lengthOf(image.steps[2]);
      if (off <= kMost) continue;
      fail(files[n], "slices must be evenly spaced, but this one lies " + shortNumber(off) +
                         " of a step beside its place");
    }
  }
  image.read = [files](std::int64_t first, std::int64_t count, std::vector<float>& values) {
    const std::size_t area = values.size() / static_cast<std::size_t>(count);
    for (std::int64_t n = 0; n < count; ++n) {
      ImageFile(files[static_cast<std::size_t>(first + n)])
          .read(0, 1, values.data() + static_cast<std::size_t>(n) * area);
    }
  };
  return image;
}

}  // namespace

void requireImageReader() {}

std::string imageHelp(const std::string& help) { return help; }

ImageSlices openImage(const std::vector<std::string>& inputs,
                      const std::optional<std::string>& series) {
  std::vector<std::string> files = inputs;
  if (inputs.size() == 1 && std::filesystem::is_directory(inputs.front())) {
    files = filesOfSeries(inputs.front(), series);
  } else if (series) {
    throw Error(ErrorCode::InvalidArgument, "--series is for a folder");
  }
  if (files.size() > 1) return openStack(files);
  const auto file = std::make_shared<ImageFile>(files.front());
  file->requireWhole();
  ImageSlices image;
  image.size = file->size();
  for (unsigned axis = 0; axis < 3; ++axis) image.steps[axis] = file->step(axis);
  image.origin = file->origin();
  image.read = [file](std::int64_t first, std::int64_t count, std::vector<float>& values) {
    file->read(first, count, values.data());
  };
  return image;
}

}  // namespace tufa::tools
