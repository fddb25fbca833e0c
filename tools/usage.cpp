#include "usage.h"

#include <CLI/CLI.hpp>

#include <tufa/error.h>
#include <algorithm>
#include <cstddef>
#include <numeric>

namespace tufa::tools {
namespace {

std::vector<std::string> subcommandNames(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* const command : app.get_subcommands([](const CLI::App*) { return true; })) {
    names.push_back(command->get_name());
  }
  return names;
}

/// How many letters to insert, remove or replace to make one word of another (Levenshtein 1966).
std::size_t editDistance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

/// Says that there is no such subcommand, and which one may have been meant: the nearest, if at
/// most every other letter differs, or one that the word begins.
std::string unknownSubcommand(const CLI::App& app, const std::string& word) {
  std::string nearest;
  std::size_t least = std::max<std::size_t>(1, word.size() / 2) + 1;
  for (const std::string& name : subcommandNames(app)) {
    const std::size_t distance = name.starts_with(word) ? 0 : editDistance(word, name);
    if (distance >= least) continue;
    least = distance;
    nearest = name;
  }
  return "there is no subcommand " + word +
         (nearest.empty() ? "" : "; did you mean " + nearest + "?");
}

std::string oneLine(std::string text) {
  const auto end = text.find_last_not_of(" \n");
  text.erase(end == std::string::npos ? 0 : end + 1);
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

/// CLI11 lists what it did not expect from the last to the first.
std::string unexpected(const std::vector<std::string>& extras) {
  std::string text = extras.size() == 1 ? "unexpected argument" : "unexpected arguments";
  for (const std::string& word : extras) text += " " + word;
  return text;
}

}  // namespace

std::string describeMisuse(const CLI::App& app, const CLI::ParseError& error,
                           const std::vector<std::string>& words) {
  const auto parsed = app.get_subcommands();
  const auto extras = app.remaining(true);
  if (parsed.empty() && !words.empty() && !words.front().starts_with('-')) {
    return unknownSubcommand(app, words.front()) + " (see tufa --help)";
  }
  if (parsed.empty() && !words.empty()) {
    return "there is no option " + words.front() + "; a subcommand comes first (see tufa --help)";
  }
  const std::string command = parsed.empty() ? "" : " " + parsed.front()->get_name();
  const bool extra = dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr && !extras.empty();
  const std::string what = extra ? unexpected(extras) : oneLine(error.what());
  return what + " (see tufa" + command + " --help)";
}

std::string helpOf(const CLI::App& app, const std::string& subcommand) {
  // App::help() would be that of the subcommand `help`, which has been parsed.
  if (subcommand.empty()) {
    return app.get_formatter()->make_help(&app, app.get_name(), CLI::AppFormatMode::Normal);
  }
  const auto names = subcommandNames(app);
  if (std::find(names.begin(), names.end(), subcommand) == names.end()) {
    throw Error(ErrorCode::InvalidArgument, unknownSubcommand(app, subcommand));
  }
  return app.get_subcommand(subcommand)->help("tufa");
}

}  // namespace tufa::tools
