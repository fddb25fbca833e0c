// mutate FOLDER [SECONDS [SEED]]: damages files of every kind and hands them to every subcommand
// that reads them, in processes under limits of memory and time. The oracle is the exit code: no
// signal, no code without a meaning, and one line for each refusal. Inputs that break this stay in
// FOLDER/broken. SECONDS is the environment's TUFA_MUTATE_SECONDS by default, or 15.

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <map>
#include <string>
#include <vector>

#include "fuzz/mutate/mutations.h"
#include "support/scratch_folder.h"
#include "tools/limited_run.h"

namespace tufa::fuzz {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

/// One way to read a file: the words of a command, with the file's name in place of FILE.
struct Reader {
  std::vector<std::string> words;
  bool mayBeMisuse = false;  ///< a file may make an option one out of range: exit code 2
};

class Mutator {
 public:
  Mutator(fs::path folder, std::uint64_t seed) : folder_(std::move(folder)), mutations_(seed) {
    fs::remove_all(folder_);
    fs::create_directories(folder_ / "broken");
    makeSeeds();
    requireSoundSeeds();
  }

  /// How many inputs broke the promise.
  int run(double seconds) {
    const auto begin = Clock::now();
    const auto elapsed = [&] {
      return std::chrono::duration<double>(Clock::now() - begin).count();
    };
    for (; elapsed() < seconds; ++runs_) attempt();
    std::cout << runs_ << " runs in " << elapsed() << " s, exit codes";
    for (const auto& [code, count] : codes_) std::cout << "  " << code << ": " << count;
    std::cout << "\n" << broken_ << " broke the promise\n";
    return broken_;
  }

 private:
  [[nodiscard]] std::string at(const std::string& name) const { return (folder_ / name).string(); }

  void prepare(std::vector<std::string> words) {
    words.insert(words.begin(), "tufa");
    const auto outcome = test::runLimited(words, at("errors"));
    if (outcome.exitCode == 0) return;
    std::cerr << "cannot make what is to be damaged: " << outcome.err;
    std::exit(2);
  }

  void makeSeeds() {
    for (const char* shape : {"sphere", "fog", "bracket"}) {
      prepare({"make", shape, "--voxel", "0.2", "-o", at(std::string(shape) + ".vdb"), "--quiet"});
      seeds_["vdb"].push_back(test::readBytes(at(std::string(shape) + ".vdb")));
    }
    for (const char* ending : {"ply", "obj", "off", "stl", "glb"}) {
      for (const char* shape : {"sphere", "bracket"}) {
        const std::string mesh = at(std::string("m.") + ending);
        prepare({"mesh", at(std::string(shape) + ".vdb"), "-o", mesh, "--quiet"});
        seeds_[ending].push_back(test::readBytes(mesh));
      }
    }
    for (const char* option : {"--quantize", "--compress"}) {
      prepare({"lod", at("bracket.vdb"), "-o", at("m.glb"), "--quiet", option});
      seeds_["glb"].push_back(test::readBytes(at("m.glb")));
    }
    for (const char* format : {"glb", "ply"}) {
      const std::string name = std::string("chunks-") + format;
      prepare({"chunks", at("sphere.vdb"), "-o", at(name), "--chunk", "8", "--levels", "2",
               "--format", format, "--quiet"});
      std::vector<std::string>& files = chunkFiles_[name];
      for (const auto& entry : fs::directory_iterator(at(name))) {
        files.push_back(entry.path().filename().string());
      }
      std::sort(files.begin(), files.end());
    }
  }

  /// What is not damaged must be read: else the rest would show nothing.
  void requireSoundSeeds() {
    for (const auto& [ending, files] : seeds_) {
      const std::string file = at("input." + ending);
      test::writeBytes(file, files.front());
      for (const Reader& reader : readersOf(ending)) {
        const test::LimitedOutcome outcome =
            test::runLimited(commandOf(reader, file), at("errors"));
        if (outcome.exitCode == 0 || outcome.exitCode == 1) continue;
        std::cerr << "a sound file is refused: " << outcome.err;
        std::exit(2);
      }
    }
  }

  [[nodiscard]] static std::vector<std::string> commandOf(const Reader& reader,
                                                          const std::string& file) {
    std::vector<std::string> words{"tufa"};
    for (const std::string& word : reader.words) words.push_back(word == "FILE" ? file : word);
    return words;
  }

  [[nodiscard]] std::vector<Reader> readersOf(const std::string& ending) const {
    if (ending != "vdb") {
      return {
          {{"check", "FILE", "--quiet"}},
          // Far vertices make bands of gigabytes, and OpenVDB ends the process where memory ends.
          {{"voxelize", "FILE", "--voxel", "0.3", "--band-voxels", "1000000", "-o", at("v.vdb"),
            "--quiet"},
           true}};
    }
    return {{{"info", "FILE"}},
            {{"info", "FILE", "--json"}},
            {{"mesh", "FILE", "-o", at("o.ply"), "--iso", "auto", "--quiet"}},
            {{"picture", "FILE", "-o", at("o.png"), "--iso", "auto", "--size", "9x9", "--quiet"}},
            {{"mesh", "FILE", "-o", at("o.glb"), "--uniform", "--iso", "0.1", "--nan", "outside"}},
            {{"mesh", "FILE", "-o", at("o.obj"), "--grid", "*", "--iso", "auto", "--quiet"}},
            {{"mesh", "FILE", "-o", at("o.ply"), "--iso", "0", "--tolerance-grid", "sphere"}, true},
            {{"lod", "FILE", "-o", at("o.glb"), "--levels", "2", "--iso", "auto", "--quiet"}},
            {{"chunks", "FILE", "-o", at("c"), "--levels", "2", "--iso", "auto", "--quiet"}},
            {{"check", at("m.ply"), "--against", "FILE", "--iso", "0", "--quiet"}}};
  }

  void attempt() {
    if (mutations_.below(6) == 0) return attemptChunks();
    auto kind = seeds_.begin();
    // Every second one a volume, the largest format with the most readers.
    if (mutations_.below(2) == 0) {
      kind = seeds_.find("vdb");
    } else {
      std::advance(kind, static_cast<std::ptrdiff_t>(mutations_.below(seeds_.size())));
    }
    const auto& files = kind->second;
    const std::string bytes = mutations_.mutated(files[mutations_.below(files.size())],
                                                 files[mutations_.below(files.size())]);
    const std::string file = at("input." + kind->first);
    test::writeBytes(file, bytes);
    const std::vector<Reader> readers = readersOf(kind->first);
    judge(readers[mutations_.below(readers.size())], file, bytes);
  }

  /// A folder of which one file, often chunks.json, is damaged.
  void attemptChunks() {
    auto chosen = chunkFiles_.begin();
    std::advance(chosen, static_cast<std::ptrdiff_t>(mutations_.below(chunkFiles_.size())));
    const auto& [name, files] = *chosen;
    const std::string victim =
        mutations_.below(2) == 0 ? "chunks.json" : files[mutations_.below(files.size())];
    const fs::path path = folder_ / name / victim;
    const std::string whole = test::readBytes(path);
    const std::string other =
        test::readBytes(folder_ / name / files[mutations_.below(files.size())]);
    const std::string bytes = mutations_.mutated(whole, other);
    test::writeBytes(path, bytes);
    const char* const lods[] = {"all:0", "all:1", "random:3", "camera:2,1,0"};
    judge({{"chunks", "--assemble", at(name), "--lods", lods[mutations_.below(4)], "-o",
            at("o.ply"), "--quiet"},
           true},
          path, bytes);
    test::writeBytes(path, whole);
  }

  void judge(const Reader& reader, const std::string& file, const std::string& bytes) {
    const std::vector<std::string> words = commandOf(reader, file);
    constexpr test::RunLimits kLimits{rlim_t{2} << 30, 20};
    const test::LimitedOutcome outcome = test::runLimited(words, at("errors"), kLimits);
    ++codes_[outcome.exitCode];
    fs::remove_all(folder_ / "c");
    if (isSound(outcome, reader)) return;
    ++broken_;
    std::string line;
    for (const std::string& word : words) line += word + " ";
    const std::string kept =
        "broken/" + std::to_string(runs_) + "-" + fs::path(file).filename().string();
    test::writeBytes(at(kept), bytes);
    std::cout << "exit code " << outcome.exitCode << ", " << outcome.cpuSeconds << " s: " << line
              << "\n  kept as " << at(kept) << "\n  " << outcome.err << std::endl;
  }

  static bool isSound(const test::LimitedOutcome& outcome, const Reader& reader) {
    if (outcome.exitCode == 0 || outcome.exitCode == 1) return true;
    if (outcome.exitCode != 3 && !(outcome.exitCode == 2 && reader.mayBeMisuse)) return false;
    // Notes may come before the one line of the refusal.
    std::size_t refusals = 0;
    for (std::size_t begin = 0; begin < outcome.err.size();) {
      const std::size_t end = std::min(outcome.err.find('\n', begin), outcome.err.size());
      const std::string_view line = std::string_view(outcome.err).substr(begin, end - begin);
      if (!line.starts_with("tufa: ")) return false;
      if (!line.starts_with("tufa: note: ")) ++refusals;
      begin = end + 1;
    }
    return refusals == 1;
  }

  fs::path folder_;
  Mutations mutations_;
  std::map<std::string, std::vector<std::string>> seeds_;       ///< by ending
  std::map<std::string, std::vector<std::string>> chunkFiles_;  ///< by folder
  std::map<int, int> codes_;
  int runs_ = 0;
  int broken_ = 0;
};

}  // namespace
}  // namespace tufa::fuzz

int main(int argc, char** argv) {
  if (argc < 2 || argc > 4) {
    std::cerr << "usage: mutate FOLDER [SECONDS [SEED]]\n";
    return 2;
  }
  const char* const wanted = std::getenv("TUFA_MUTATE_SECONDS");
  const double seconds = std::atof(argc > 2 ? argv[2] : wanted != nullptr ? wanted : "15");
  const auto seed = argc > 3 ? std::strtoull(argv[3], nullptr, 10) : 1;
  return tufa::fuzz::Mutator(argv[1], seed).run(seconds) == 0 ? 0 : 1;
}
