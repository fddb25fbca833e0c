#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#ifdef __linux__
#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#ifdef __GLIBC__
#include <malloc.h>
#endif
#endif

namespace tufa::base {

/// The most memory that the process held while some work ran, beyond what it held before. Linux
/// alone can tell.
class PeakMemory {
 public:
  /// Gives freed memory back to the system first, so that the work is not lent any, and sets the
  /// system's mark of the most memory back to what is held now.
  PeakMemory() {
#ifdef __linux__
#ifdef __GLIBC__
    malloc_trim(0);
#endif
    const int file = ::open("/proc/self/clear_refs", O_WRONLY | O_CLOEXEC);
    if (file < 0) return;
    const bool reset = ::write(file, "5", 1) == 1;
    ::close(file);
    if (reset) before_ = statusBytes("VmRSS:");
#endif
  }

  /// To be asked at the end of the work, in bytes; nothing if the system does not tell.
  [[nodiscard]] std::optional<std::uint64_t> extraBytes() const {
    if (!before_) return std::nullopt;
    const auto peak = statusBytes("VmHWM:");
    if (!peak) return std::nullopt;
    return *peak > *before_ ? *peak - *before_ : 0;
  }

 private:
  /// The number of bytes behind a key of /proc/self/status, which has "KEY:  N kB".
  static std::optional<std::uint64_t> statusBytes([[maybe_unused]] std::string_view key) {
#ifdef __linux__
    const int file = ::open("/proc/self/status", O_RDONLY | O_CLOEXEC);
    if (file < 0) return std::nullopt;
    std::array<char, 8192> text{};
    const ssize_t size = ::read(file, text.data(), text.size() - 1);
    ::close(file);
    if (size <= 0) return std::nullopt;
    const std::size_t at = std::string_view(text.data(), static_cast<std::size_t>(size)).find(key);
    if (at == std::string_view::npos) return std::nullopt;
    return 1024 * std::strtoull(text.data() + at + key.size(), nullptr, 10);
#else
    return std::nullopt;
#endif
  }

  std::optional<std::uint64_t> before_;
};

}  // namespace tufa::base
