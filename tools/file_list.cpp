#include "file_list.h"

#include <tufa/error.h>
#include <algorithm>
#include <utility>

#include "console.h"
#include "failure.h"

namespace tufa::tools {

using Json = nlohmann::ordered_json;

FileList::FileList(std::vector<std::string> files, bool json)
    : files_(std::move(files)), json_(json) {}

void FileList::forEach(const std::function<int(const std::string&)>& work) {
  for (const std::string& file : files_) {
    try {
      exitCode_ = std::max(exitCode_, work(file));
    } catch (const Error& error) {
      if (files_.size() == 1 || error.code() == ErrorCode::Cancelled) throw;
      printNote(messageOf(error));
      Json object = {{"file", file}};
      object["error"] = errorToJson(nameOf(error.code()), messageOf(error));
      add(std::move(object));
      exitCode_ = std::max(exitCode_, exitCodeOf(error));
      unreadable_ = unreadable_ || error.code() == ErrorCode::UnreadableFile;
    }
  }
}

int FileList::finish() const {
  if (json_) {
    const Json whole = files_.size() == 1 ? objects_.at(0) : Json{{"files", objects_}};
    print(whole.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
  }
  if (unreadable_) endAtOnce(exitCode_);
  return exitCode_;
}

}  // namespace tufa::tools
