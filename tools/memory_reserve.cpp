#include "memory_reserve.h"

#include <malloc.h>
#include <sys/mman.h>
#include <unistd.h>

#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <exception>
#include <new>
#include <string_view>

#include "commands.h"

namespace tufa::tools {
namespace {

// From this size on.
constexpr int kLargeBytes = 8 << 20;
// What the allocator may hold back at the end of its heap. With less, phases give back the same
// pages and fault them in again thousands of times: a tenth of the time of ten million voxels.
constexpr int kKeptBytes = 16 << 20;
constexpr std::size_t kReserveBytes = std::size_t{16} << 20;

std::atomic<void*> reserve = nullptr;

/// Not once more: the allocation fails, so that the call ends.
void giveReserveBack() {
  std::free(reserve.exchange(nullptr));
  throw std::bad_alloc();
}

bool isOutOfMemory() {
  const std::exception_ptr error = std::current_exception();
  if (!error) return false;
  try {
    std::rethrow_exception(error);
  } catch (const std::bad_alloc&) {
    return true;
  } catch (...) {
    return false;
  }
}

void endOutOfMemory() {
  if (!isOutOfMemory()) std::abort();
  constexpr std::string_view kText = "tufa: out of memory\n";
  [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, kText.data(), kText.size());
  ::_exit(kUnusableFile);
}

}  // namespace

bool isMemoryAtItsEnd() {
  constexpr std::size_t kStack = std::size_t{8} << 20;
  void* const probe =
      ::mmap(nullptr, kStack, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (probe == MAP_FAILED) return true;
  ::munmap(probe, kStack);
  return false;
}

void giveLargeMemoryBack() {
#ifdef M_MMAP_THRESHOLD
  static_cast<void>(mallopt(M_MMAP_THRESHOLD, kLargeBytes));
  static_cast<void>(mallopt(M_TRIM_THRESHOLD, kKeptBytes));
#endif
}

void keepMemoryInReserve() {
  reserve = std::malloc(kReserveBytes);
  std::set_new_handler(giveReserveBack);
  std::set_terminate(endOutOfMemory);
}

}  // namespace tufa::tools
