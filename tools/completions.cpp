#include "completions.h"

#include <CLI/CLI.hpp>

#include <ostream>
#include <string>
#include <vector>

#include "option_words.h"

namespace tufa::tools {
namespace {

std::vector<std::string> namesOf(const CLI::Option& option) {
  std::vector<std::string> names;
  for (const std::string& name : option.get_snames()) names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) names.push_back("--" + name);
  return names;
}

/// A text within single quotes, where `special` characters have a backslash.
std::string quoted(const std::string& text, const std::string& special) {
  std::string quoted;
  for (const char c : text) {
    if (c == '\'') {
      quoted += "'\\''";
      continue;
    }
    if (special.find(c) != std::string::npos) quoted += '\\';
    quoted += c;
  }
  return quoted;
}

/// The branch of the completion for one subcommand: choices after options that have some, files
/// after those that take another value, else the options' names, and files.
void writeBashBranch(std::ostream& out, const CLI::App& command) {
  std::string names;
  std::string places;
  out << "    " << command.get_name() << ")\n      case $last in\n";
  for (const CLI::Option* option : optionsOf(command, false)) {
    const auto all = namesOf(*option);
    names += (names.empty() ? "" : " ") + CLI::detail::join(all, " ");
    if (!takesValue(*option)) continue;
    out << "        " << CLI::detail::join(all, "|") << ") ";
    const auto choices = choicesOf(*option);
    if (!choices.empty()) out << "words='" << CLI::detail::join(choices, " ") << "' ";
    out << ";;\n";
  }
  for (const CLI::Option* option : optionsOf(command, true)) {
    places += CLI::detail::join(choicesOf(*option), " ");
  }
  out << "        *) if [[ $word == -* ]]; then words='" << names << "'; else words='" << places
      << "'; fi ;;\n      esac\n      ;;\n";
}

/// An option as _arguments of zsh has it: its name, what it does, and what stands behind it.
void writeZshOption(std::ostream& out, const CLI::Option& option) {
  const std::string what = quoted(option.get_description(), "[]:\\");
  for (const std::string& name : namesOf(option)) {
    out << " \\\n        '*" << name << '[' << what << ']';
    const auto choices = choicesOf(option);
    if (!choices.empty()) {
      out << ":value:(" << CLI::detail::join(choices, " ") << ')';
    } else if (takesValue(option)) {
      out << ":value:_files";
    }
    out << '\'';
  }
}

}  // namespace

void writeBashCompletion(std::ostream& out, const CLI::App& app) {
  std::string commands;
  for (const CLI::App* command : subcommandsOf(app)) commands += command->get_name() + " ";
  out << "# Completion of the command tufa for bash: names of options and their values, and "
         "files.\n"
         "_tufa() {\n"
         "  local word=${COMP_WORDS[COMP_CWORD]} last=${COMP_WORDS[COMP_CWORD-1]} words=''\n"
         "  if ((COMP_CWORD == 1)); then\n"
         "    COMPREPLY=($(compgen -W '"
      << commands
      << "--help --version' -- \"$word\"))\n"
         "    return\n"
         "  fi\n"
         "  case ${COMP_WORDS[1]} in\n";
  for (const CLI::App* command : subcommandsOf(app)) writeBashBranch(out, *command);
  out << "  esac\n"
         "  if [[ $words ]]; then\n"
         "    COMPREPLY=($(compgen -W \"$words\" -- \"$word\"))\n"
         "  else\n"
         "    compopt -o filenames 2>/dev/null\n"
         "    mapfile -t COMPREPLY < <(compgen -f -- \"$word\")\n"
         "  fi\n"
         "}\n"
         "complete -F _tufa tufa\n";
}

void writeZshCompletion(std::ostream& out, const CLI::App& app) {
  out << "#compdef tufa\n"
         "_tufa() {\n"
         "  local -a commands\n"
         "  if (( CURRENT == 2 )); then\n"
         "    commands=(\n";
  for (const CLI::App* command : subcommandsOf(app)) {
    out << "      '" << command->get_name() << ':' << quoted(command->get_description(), ":\\")
        << "'\n";
  }
  out << "    )\n"
         "    _describe subcommand commands\n"
         "    return\n"
         "  fi\n"
         "  shift words\n"
         "  (( CURRENT-- ))\n"
         "  case $words[1] in\n";
  for (const CLI::App* command : subcommandsOf(app)) {
    out << "    " << command->get_name() << ")\n      _arguments";
    for (const CLI::Option* option : optionsOf(*command, false)) writeZshOption(out, *option);
    std::vector<std::string> places;
    for (const CLI::Option* option : optionsOf(*command, true)) {
      for (const std::string& choice : choicesOf(*option)) places.push_back(choice);
    }
    const std::string files =
        places.empty() ? "_files" : "(" + CLI::detail::join(places, " ") + ")";
    out << " \\\n        '*:file:" << files << "'\n      ;;\n";
  }
  out << "  esac\n"
         "}\n"
         "_tufa \"$@\"\n";
}

void writeFishCompletion(std::ostream& out, const CLI::App& app) {
  out << "# Completion of the command tufa for fish.\n";
  for (const CLI::App* command : subcommandsOf(app)) {
    out << "complete -c tufa -n __fish_use_subcommand -f -a " << command->get_name() << " -d '"
        << quoted(command->get_description(), "\\") << "'\n";
  }
  for (const CLI::App* command : subcommandsOf(app)) {
    const std::string where =
        "complete -c tufa -n '__fish_seen_subcommand_from " + command->get_name() + "'";
    for (const CLI::Option* option : optionsOf(*command, false)) {
      out << where;
      for (const std::string& name : option->get_snames()) out << " -s " << name;
      for (const std::string& name : option->get_lnames()) out << " -l " << name;
      const auto choices = choicesOf(*option);
      if (!choices.empty()) {
        out << " -x -a '" << CLI::detail::join(choices, " ") << '\'';
      } else if (takesValue(*option)) {
        out << " -r";
      }
      out << " -d '" << quoted(option->get_description(), "\\") << "'\n";
    }
    for (const CLI::Option* option : optionsOf(*command, true)) {
      const auto choices = choicesOf(*option);
      if (choices.empty()) continue;
      out << where << " -f -a '" << CLI::detail::join(choices, " ") << "'\n";
    }
  }
}

}  // namespace tufa::tools
