// Writes manual pages and a completion for bash from the command's own options and help texts.

#include <CLI/CLI.hpp>

#include <tufa/io.h>
#include <tufa/version.h>
#include <filesystem>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

#include "commands.h"

namespace {

using Options = std::vector<const CLI::Option*>;
using Apps = std::vector<const CLI::App*>;

Options optionsOf(const CLI::App& app, bool positional) {
  return app.get_options(
      [positional](const CLI::Option* option) { return option->get_positional() == positional; });
}

Apps subcommandsOf(const CLI::App& app) { return app.get_subcommands({}); }

/// Text for troff: dashes that can be copied, and no line that troff would read as a request.
std::string troff(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '-' || c == '\\') escaped += '\\';
    escaped += c;
  }
  return escaped.starts_with('.') || escaped.starts_with('\'') ? "\\&" + escaped : escaped;
}

/// The values that an option takes, where they are a list; CLI11 tells it as TEXT:{a,b}.
std::vector<std::string> choicesOf(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const auto open = type.find('{');
  const auto close = type.find('}');
  if (open == std::string::npos || close == std::string::npos) return {};
  return CLI::detail::split(type.substr(open + 1, close - open - 1), ',');
}

/// What stands for the option's value on the command line; empty for flags.
std::string valueOf(const CLI::Option& option) {
  if (option.get_expected_max() == 0) return {};
  const auto choices = choicesOf(option);
  if (!choices.empty()) return CLI::detail::join(choices, "|");
  const std::string type = option.get_type_name();
  return type.substr(0, type.find(':'));
}

std::vector<std::string> namesOf(const CLI::Option& option) {
  std::vector<std::string> names;
  for (const std::string& name : option.get_snames()) names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) names.push_back("--" + name);
  return names;
}

void writeOption(std::ostream& out, const CLI::Option& option) {
  const bool positional = option.get_positional();
  std::string names = troff(positional ? option.get_name(true) : "");
  for (const std::string& name : namesOf(option)) {
    names += (names.empty() ? "" : "\\fR, \\fB") + troff(name);
  }
  out << ".TP\n\\fB" << names << "\\fR";
  const std::string value = positional && choicesOf(option).empty() ? "" : valueOf(option);
  if (!value.empty()) out << " \\fI" << troff(value) << "\\fR";
  out << '\n' << troff(option.get_description()) << '\n';
  const std::string preset = option.get_default_str();
  if (!preset.empty() && valueOf(option) != "") out << "(default " << troff(preset) << ")\n";
}

void writeHead(std::ostream& out, const std::string& name, const std::string& description) {
  out << ".TH " << name << " 1 \"\" \"tufa " << tufa::version()
      << "\" \"User commands\"\n.SH NAME\n"
      << troff(name) << " \\- " << troff(description) << "\n.SH SYNOPSIS\n";
}

void writeOptions(std::ostream& out, const CLI::App& app) {
  out << ".SH OPTIONS\n";
  for (const CLI::Option* option : optionsOf(app, true)) writeOption(out, *option);
  for (const CLI::Option* option : optionsOf(app, false)) writeOption(out, *option);
}

void writeExitCodes(std::ostream& out) {
  out << ".SH EXIT STATUS\n"
         ".TP\n0\ndone\n"
         ".TP\n1\nthe checked mesh is not watertight, or the volume not fine enough\n"
         ".TP\n2\nwrong usage\n"
         ".TP\n3\na file that cannot be read, written or meshed\n"
         ".TP\n130\ncancelled by Ctrl\\-C or SIGTERM\n";
}

void writeMainPage(std::ostream& out, const CLI::App& app) {
  writeHead(out, app.get_name(), app.get_description());
  out << "\\fBtufa\\fR \\fISUBCOMMAND\\fR [\\fIOPTION\\fR...]\n.SH SUBCOMMANDS\n";
  for (const CLI::App* command : subcommandsOf(app)) {
    out << ".TP\n\\fBtufa\\-" << command->get_name() << "\\fR(1)\n"
        << troff(command->get_description()) << '\n';
  }
  writeOptions(out, app);
  writeExitCodes(out);
}

void writePage(std::ostream& out, const CLI::App& command) {
  writeHead(out, "tufa-" + command.get_name(), command.get_description());
  out << "\\fBtufa " << command.get_name() << "\\fR [\\fIOPTION\\fR...]";
  for (const CLI::Option* option : optionsOf(command, true)) {
    out << " \\fI" << option->get_name(true) << "\\fR"
        << (option->get_items_expected_max() > 1 ? "..." : "");
  }
  out << '\n';
  writeOptions(out, command);
  writeExitCodes(out);
  out << ".SH SEE ALSO\n.BR tufa (1)\n";
}

/// The branch of the completion for one subcommand: choices after options that have some, files
/// after those that take another value, else the options' names, and files.
void writeCompletion(std::ostream& out, const CLI::App& command) {
  std::string names;
  std::string places;
  out << "    " << command.get_name() << ")\n      case $last in\n";
  for (const CLI::Option* option : optionsOf(command, false)) {
    const auto all = namesOf(*option);
    names += (names.empty() ? "" : " ") + CLI::detail::join(all, " ");
    if (option->get_expected_max() == 0) continue;
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

void writeCompletions(std::ostream& out, const CLI::App& app) {
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
  for (const CLI::App* command : subcommandsOf(app)) writeCompletion(out, *command);
  out << "  esac\n"
         "  if [[ $words ]]; then\n"
         "    COMPREPLY=($(compgen -W \"$words\" -- \"$word\"))\n"
         "  else\n"
         "    compopt -o filenames 2>/dev/null\n"
         "    COMPREPLY=($(compgen -f -- \"$word\"))\n"
         "  fi\n"
         "}\n"
         "complete -F _tufa tufa\n";
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: tufa_pages FOLDER\n";
    return 2;
  }
  const std::filesystem::path folder = argv[1];
  std::filesystem::create_directories(folder / "man1");
  CLI::App app;
  tufa::tools::Command chosen;
  tufa::tools::declareCommand(app, chosen);

  const auto writeText = [&](const std::string& name, const auto& writeTo) {
    std::ostringstream text;
    writeTo(text);
    tufa::writeFile(text.str(), folder / name);
  };
  writeText("man1/tufa.1", [&](std::ostream& page) { writeMainPage(page, app); });
  for (const CLI::App* command : subcommandsOf(app)) {
    writeText("man1/tufa-" + command->get_name() + ".1",
              [&](std::ostream& page) { writePage(page, *command); });
  }
  writeText("tufa.bash", [&](std::ostream& completion) { writeCompletions(completion, app); });
  return 0;
}
