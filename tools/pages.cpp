// Writes manual pages and completions for shells from the command's own options and help texts.

#include <CLI/CLI.hpp>

#include <tufa/io.h>
#include <tufa/version.h>
#include <filesystem>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

#include "commands.h"
#include "completions.h"
#include "option_words.h"
#include "page_texts.h"

namespace {

using tufa::tools::choicesOf;
using tufa::tools::optionsOf;
using tufa::tools::subcommandsOf;
using tufa::tools::takesValue;

/// Text for troff: dashes that can be copied, and no line that troff would read as a request.
std::string troff(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '-' || c == '\\') escaped += '\\';
    escaped += c;
  }
  return escaped.starts_with('.') || escaped.starts_with('\'') ? "\\&" + escaped : escaped;
}

/// What stands for the option's value on the command line; empty for flags.
std::string valueOf(const CLI::Option& option) {
  if (!takesValue(option)) return {};
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
  const tufa::tools::PageText& text = tufa::tools::pageText(command.get_name());
  out << ".SH DESCRIPTION\n" << troff(text.description) << '\n';
  writeOptions(out, command);
  out << ".SH EXAMPLES\n";
  for (const auto& [example, what] : text.examples) {
    out << ".TP\n\\fB" << troff(example) << "\\fR\n" << troff(what) << '\n';
  }
  writeExitCodes(out);
  out << ".SH SEE ALSO\n.BR tufa (1)\n";
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
  writeText("tufa.zsh", [&](std::ostream& text) { tufa::tools::writeZshCompletion(text, app); });
  writeText("tufa.fish", [&](std::ostream& text) { tufa::tools::writeFishCompletion(text, app); });
  // What the build looks for comes last.
  writeText("tufa.bash", [&](std::ostream& text) { tufa::tools::writeBashCompletion(text, app); });
  return 0;
}
