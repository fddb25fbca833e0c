#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace tufa::tools {

/// The files of a subcommand that takes several. One alone is as if there were no list: its failure
/// is that of the subcommand, and its JSON object stands by itself. Of several each is worked on,
/// whatever becomes of the others, and the objects are the list "files".
class FileList {
 public:
  FileList(std::vector<std::string> files, bool json);

  /// Calls work(file) for each, which returns an exit code. Of several files the Error of one is
  /// told, and the others follow, unless it is the user's wish to stop.
  void forEach(const std::function<int(const std::string&)>& work);

  /// What there is to tell of the file that is being worked on.
  void add(nlohmann::ordered_json object) { objects_.push_back(std::move(object)); }

  /// Prints the objects, if there is to be JSON; returns the greatest exit code.
  [[nodiscard]] int finish() const;

 private:
  std::vector<std::string> files_;
  bool json_;
  nlohmann::ordered_json objects_ = nlohmann::ordered_json::array();
  int exitCode_ = 0;
  bool unreadable_ = false;  ///< some file: the heap may be broken
};

}  // namespace tufa::tools
