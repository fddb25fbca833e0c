#include "usage.h"

#include <CLI/CLI.hpp>

#include <tufa/error.h>
#include <algorithm>
#include <cstddef>
#include <memory>
#include <numeric>

#include "option_words.h"

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

/// Which of some names may have been meant: the nearest, if at most `most` letters differ, or one
/// that the word begins; empty if there is none.
std::string didYouMean(const std::string& word, const std::vector<std::string>& names,
                       std::size_t most) {
  std::string nearest;
  std::size_t least = most + 1;
  for (const std::string& name : names) {
    const std::size_t distance = name.starts_with(word) ? 0 : editDistance(word, name);
    if (distance >= least) continue;
    least = distance;
    nearest = name;
  }
  return nearest.empty() ? "" : "; did you mean " + nearest + "?";
}

std::string unknownSubcommand(const CLI::App& app, const std::string& word) {
  const std::size_t most = std::max<std::size_t>(1, word.size() / 2);
  return "there is no subcommand " + word + didYouMean(word, subcommandNames(app), most);
}

/// Of an option that a subcommand does not have, without the value that may stand behind it.
std::string unknownOption(const CLI::App& command, const std::string& word) {
  std::vector<std::string> names;
  for (const CLI::Option* const option : optionsOf(command, false)) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  const std::string name = word.substr(0, word.find('='));
  return "there is no option " + word +
         didYouMean(name, names, std::max<std::size_t>(1, name.size() / 4));
}

std::string oneLine(std::string text) {
  const auto end = text.find_last_not_of(" \n");
  text.erase(end == std::string::npos ? 0 : end + 1);
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

std::string unexpected(const CLI::App& command, const std::vector<std::string>& extras) {
  for (const std::string& word : extras) {
    if (word.starts_with("--")) return unknownOption(command, word);
    if (word.starts_with('-')) {
      return "there is no option " + word + "; a file of that name is written ./" + word;
    }
  }
  std::string text = extras.size() == 1 ? "unexpected argument" : "unexpected arguments";
  for (const std::string& word : extras) text += " " + word;
  // What a shell makes of *.vdb.
  if (extras.front().ends_with(".vdb")) {
    text += "; tufa mesh takes the frames of a sequence by one name in quotes, 'smoke.####.vdb'";
  }
  return text;
}

/// Of "Could not convert: --seed = -5", what the option takes.
std::string notTaken(const CLI::App& command, const std::string& message) {
  const std::string_view begin = "Could not convert: ";
  const std::size_t equals = message.find(" = ");
  if (!message.starts_with(begin) || equals == std::string::npos) return message;
  const std::string name = message.substr(begin.size(), equals - begin.size());
  const std::string value = message.substr(equals + 3);
  const CLI::Option* const option = command.get_option_no_throw(name);
  const std::string type = option == nullptr ? "" : option->get_type_name();
  std::string taken = "a value that it takes";
  if (type.starts_with("UINT")) taken = "a whole number, 0 or more";
  if (type.starts_with("INT")) taken = "a whole number";
  if (type.starts_with("FLOAT")) taken = "a number";
  return name + ": " + value + " is not " + taken;
}

class Formatter : public CLI::Formatter {
 public:
  std::string make_option_name(const CLI::Option* option, bool isPositional) const override {
    if (isPositional) return CLI::Formatter::make_option_name(option, isPositional);
    std::string names;
    const auto add = [&](const char* dashes, const std::vector<std::string>& all) {
      for (const std::string& name : all) names += (names.empty() ? "" : ",") + (dashes + name);
    };
    add("-", option->get_snames());
    add("--", option->get_lnames());
    return names;
  }
};

}  // namespace

void nameFlagsAsTyped(CLI::App& app) { app.formatter(std::make_shared<Formatter>()); }

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
  // Of a mistyped option it may be said that it is required.
  const bool extra = (dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr ||
                      dynamic_cast<const CLI::RequiredError*>(&error) != nullptr) &&
                     !parsed.empty() && !extras.empty();
  std::string what = extra ? unexpected(*parsed.front(), extras) : oneLine(error.what());
  if (!parsed.empty()) what = notTaken(*parsed.front(), what);
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
