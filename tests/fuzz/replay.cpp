// Runs a fuzz target without libFuzzer: on every file of the folders it is given, or, given two
// numbers, on that many random inputs from that seed on; a broken promise or a crash then leaves
// its input in the file broken_promise.

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "fuzz.h"

namespace {

void runOn(const std::string& bytes) {
  LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
}

void runOnFiles(std::vector<std::filesystem::path> files) {
  std::sort(files.begin(), files.end());
  for (const auto& file : files) {
    std::printf("%s\n", file.c_str());
    std::fflush(stdout);  // the last line names the file that broke a promise
    std::ifstream stream(file, std::ios::binary);
    runOn({std::istreambuf_iterator<char>(stream), {}});
  }
}

/// The input at hand, for the handler of signals.
std::string current;

void keepInput(int signal) {
  const int file = ::open("broken_promise", O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (file >= 0 && ::write(file, current.data(), current.size()) >= 0) ::close(file);
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

void runOnRandomInputs(std::uint64_t count, std::uint64_t seed) {
  for (const int signal : {SIGABRT, SIGSEGV, SIGBUS, SIGFPE}) std::signal(signal, keepInput);
  constexpr std::size_t kLongest = 128;
  for (std::uint64_t n = seed; n < seed + count; ++n) {
    std::mt19937_64 random(n);
    current.assign(1 + random() % kLongest, '\0');
    for (char& byte : current) byte = static_cast<char>(random() % 256);
    runOn(current);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const auto isNumber = [](const std::string& word) {
    return word.find_first_not_of("0123456789") == std::string::npos;
  };
  if (argc == 3 && isNumber(argv[1]) && isNumber(argv[2])) {
    runOnRandomInputs(std::stoull(argv[1]), std::stoull(argv[2]));
    return 0;
  }
  std::vector<std::filesystem::path> files;
  for (int n = 1; n < argc; ++n) {
    for (const auto& entry : std::filesystem::directory_iterator(argv[n])) {
      files.push_back(entry.path());
    }
  }
  runOnFiles(files);
  return files.empty() ? 1 : 0;
}
