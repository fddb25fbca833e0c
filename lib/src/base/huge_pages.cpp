#include "base/huge_pages.h"

#ifdef __linux__
#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#endif

namespace tufa::base {

#ifdef __linux__
namespace {

// Calls advise(begin, bytes) for the whole pages of some memory.
template <class Advise>
void forWholePages(void* begin, std::size_t bytes, const Advise& advise) {
  const auto page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
  const auto address = reinterpret_cast<std::uintptr_t>(begin);
  const std::uintptr_t first = (address + page - 1) / page * page;
  const std::uintptr_t last = (address + bytes) / page * page;
  if (first < last) advise(reinterpret_cast<void*>(first), last - first);
}

}  // namespace

// What is advised here changes nothing but the speed, nor does a refusal.

void adviseHugePages(void* begin, std::size_t bytes) {
  constexpr std::size_t kHugePage = std::size_t{2} << 20;
  if (bytes < 2 * kHugePage) return;
  forWholePages(begin, bytes,
                [](void* first, std::size_t size) { (void)madvise(first, size, MADV_HUGEPAGE); });
}

void populate([[maybe_unused]] void* begin, [[maybe_unused]] std::size_t bytes) {
#ifdef MADV_POPULATE_WRITE  // Linux 5.14
  forWholePages(begin, bytes, [](void* first, std::size_t size) {
    (void)madvise(first, size, MADV_POPULATE_WRITE);
  });
#endif
}
#else
void populate(void*, std::size_t) {}
void adviseHugePages(void*, std::size_t) {}
#endif

}  // namespace tufa::base
