// The manual page, in the macros of man(7).
#include "command_texts.h"
#include "rigproof/core/text.h"
#include "rigproof/core/version.h"

namespace rigproof {
namespace {

// A backslash begins an escape, a hyphen would be set as one, and a point or quote at the begin of a line is a request.
std::string roff(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if ((c == '.' || c == '\'') && (out.empty() || out.back() == '\n')) out += "\\&";
    out += c == '\\' ? "\\e" : c == '-' ? "\\-" : std::string(1, c);
  }
  return out;
}

std::string option_text(const OptionFacts& option) {
  std::vector<std::string> names;
  for (const std::string& name : option.names) names.push_back("\\fB" + roff(name) + "\\fR");
  const std::string value = option.value.empty() || option.is_positional() ? "" : " \\fI" + roff(option.value) + "\\fR";
  const std::string choices = option.choices.empty() ? "" : "\n.br\n" + roff("One of " + joined(option.choices)) + ".";
  return ".TP\n" + joined(names) + value + "\n" + roff(option.description) + choices + "\n";
}

std::string lines_of(const std::string& text) {
  return text.empty() ? "" : ".PP\n.nf\n" + roff(text) + (text.back() == '\n' ? "" : "\n") + ".fi\n";
}

std::string command_text(const CommandFacts& command) {
  std::string text =
      ".SS \"" + roff("rigproof " + joined(command.path, " ")) + "\"\n" + roff(command.description) + ".\n";
  for (const OptionFacts& option : command.options) text += option_text(option);
  text += lines_of(command.footer);
  for (const CommandFacts& below : command.commands) text += command_text(below);
  return text;
}

}  // namespace

std::string manual_page(const CommandFacts& program) {
  std::string text = ".TH RIGPROOF 1 \"\" \"rigproof " + std::string(version()) +
                     "\" \"\"\n.SH NAME\nrigproof \\- calibrate and prove where the cameras of a robot are\n.SH "
                     "SYNOPSIS\n.B rigproof\n.I COMMAND\n[\\fIOPTIONS\\fR] ..\n.SH DESCRIPTION\n" +
                     roff(program.description) + "\n.SH COMMANDS\n";
  for (const CommandFacts& command : program.commands)
    text += ".TP\n\\fB" + roff(command.name()) + "\\fR\n" + roff(command.description) + "\n";
  text += ".SH OPTIONS\n";
  for (const OptionFacts& option : program.options) text += option_text(option);
  text += ".SH \"EXIT STATUS\"\n" + lines_of(program.footer) + ".SH \"COMMANDS IN DETAIL\"\n";
  for (const CommandFacts& command : program.commands) text += command_text(command);
  return text;
}

}  // namespace rigproof
