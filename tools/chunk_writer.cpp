#include "chunk_writer.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <thread>
#include <utility>

namespace tufa::tools {
namespace {

// Chunks that wait to be written: enough that threads end at about the same time, and few beside
// the levels that they come from.
constexpr std::size_t kAtOnce = 128;

}  // namespace

void ChunkWriter::add(const ChunkIndex& index, Chunk&& chunk, const std::string& folder) {
  if (waiting_.empty()) index_ = index, folder_ = folder;
  waiting_.push_back(std::move(chunk));
  if (waiting_.size() == kAtOnce) finish();
}

void ChunkWriter::finish() {
  std::vector<std::vector<ChunkFile>> made(waiting_.size());
  std::vector<std::exception_ptr> errors(waiting_.size());
  std::atomic<std::size_t> next{0};
  std::atomic<bool> hasFailed{false};
  const auto work = [&] {
    for (std::size_t i; !hasFailed && (i = next++) < waiting_.size();) {
      try {
        made[i] = writeChunk(index_, waiting_[i], folder_, format_);
      } catch (...) {
        errors[i] = std::current_exception();
        hasFailed = true;
      }
    }
  };
  std::vector<std::thread> others;
  const auto most = std::min(static_cast<std::size_t>(threads_), waiting_.size());
  others.reserve(most);
  try {
    while (others.size() + 1 < most) others.emplace_back(work);
  } catch (const std::exception&) {  // no more threads, or no memory for them: fewer do it
  }
  work();
  for (std::thread& other : others) other.join();
  for (const std::exception_ptr& error : errors) {
    if (error) std::rethrow_exception(error);
  }
  for (std::size_t i = 0; i < made.size(); ++i) files_[waiting_[i].index] = std::move(made[i]);
  waiting_.clear();
}

}  // namespace tufa::tools
