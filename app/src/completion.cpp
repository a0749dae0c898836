// Scripts that complete the command line in bash, zsh and fish.
#include <functional>

#include "command_texts.h"
#include "offers.h"
#include "rigproof/core/error.h"
#include "rigproof/core/text.h"

namespace rigproof {
namespace {

void for_each(const CommandFacts& command, const std::function<void(const CommandFacts&)>& call) {
  call(command);
  for (const CommandFacts& below : command.commands) for_each(below, call);
}

// In single quotes, as all three shells take it.
std::string quoted(const std::string& text, const std::string& quote) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? quote : std::string(1, c);
  return out + "'";
}

std::string in_sh(const std::string& text) { return quoted(text, "'\\''"); }
std::string in_fish(const std::string& text) { return quoted(text, "\\'"); }

std::vector<std::string> option_names(const CommandFacts& command) {
  std::vector<std::string> names;
  for (const OptionFacts& option : command.options)
    if (!option.is_positional()) names.insert(names.end(), option.names.begin(), option.names.end());
  return names;
}

// What is offered for the value of an option, or for what is known by its place.
struct Values {
  std::vector<std::string> names;
  bool or_file = false;
};

Values values_of(const OptionFacts& option) {
  if (!option.choices.empty()) return {option.choices, false};
  const bool is_named = option.is_positional() && option.value == "TEXT";
  const std::string type = is_named ? option.names.front() : option.value;
  std::vector<std::string> offers = offers_of(type);
  const bool or_file = offers.empty() || may_be_file(type);
  return {std::move(offers), or_file};
}

// What may stand where no option does: commands, and the values of what is known by its place.
Values words_of(const CommandFacts& command) {
  Values words;
  for (const CommandFacts& below : command.commands) words.names.push_back(below.name());
  for (const OptionFacts& option : command.options) {
    if (!option.is_positional()) continue;
    const Values values = values_of(option);
    words.names.insert(words.names.end(), values.names.begin(), values.names.end());
    words.or_file = words.or_file || values.or_file;
  }
  return words;
}

// -----------------------------------------------------------------------------------------------------------------
// bash

// Without names nothing is offered, and the shell completes those of files.
std::string bash_offer(const Values& values) {
  if (values.names.empty()) return "COMPREPLY=()";
  return std::string("_rigproof_") + (values.or_file ? "names_or_files " : "names ") + in_sh(joined(values.names, " "));
}

std::string bash_values(const CommandFacts& command) {
  std::string text;
  for (const OptionFacts& option : command.options) {
    if (option.is_positional() || option.value.empty()) continue;
    std::vector<std::string> patterns;
    for (const std::string& name : option.names) patterns.push_back(in_sh(joined(command.path, " ") + " " + name));
    text += "    " + joined(patterns, "|") + ") " + bash_offer(values_of(option)) + "; return ;;\n";
  }
  return text;
}

std::string bash_script(const CommandFacts& program) {
  std::vector<std::string> paths;
  std::string words, values;
  for_each(program, [&](const CommandFacts& command) {
    const std::string path = joined(command.path, " ");
    if (!command.path.empty()) paths.push_back(in_sh(path));
    const std::string options = "_rigproof_names " + in_sh(joined(option_names(command), " "));
    words += "    " + in_sh(path) + ") if [[ $word == -* ]]; then " + options + "; else " +
             bash_offer(words_of(command)) + "; fi ;;\n";
    values += bash_values(command);
  });
  return "# bash completion of rigproof: `source <(rigproof completion bash)`\n"
         "_rigproof_names() { mapfile -t COMPREPLY < <(compgen -P \"$prefix\" -W \"$1\" -- \"$word\"); }\n"
         "_rigproof_names_or_files() {\n"
         "  mapfile -t COMPREPLY < <(compgen -P \"$prefix\" -W \"$1\" -- \"$word\"; compgen -P \"$prefix\" -f -- "
         "\"$word\")\n"
         "  compopt -o filenames 2>/dev/null\n"
         "}\n"
         "_rigproof() {\n"
         "  local word=\"${COMP_WORDS[COMP_CWORD]}\" before=\"${COMP_WORDS[COMP_CWORD-1]}\" command= prefix= i\n"
         "  for ((i = 1; i < COMP_CWORD; i++)); do\n"
         "    case \"${command:+$command }${COMP_WORDS[i]}\" in\n"
         "    " +
         joined(paths, "|") +
         ") command=\"${command:+$command }${COMP_WORDS[i]}\" ;;\n"
         "    esac\n"
         "  done\n"
         // "--option=value" is three words where "=" breaks words, as it does unless users change that; else one.
         "  if [[ $word == = ]]; then word=\n"
         "  elif [[ $before == = ]]; then before=\"${COMP_WORDS[COMP_CWORD-2]}\"\n"
         "  elif [[ $word == --*=* ]]; then before=\"${word%%=*}\"; prefix=\"$before=\"; word=\"${word#*=}\"\n"
         "  fi\n"
         "  case \"$command $before\" in\n" +
         values +
         "  esac\n"
         "  case \"$command\" in\n" +
         words +
         "  esac\n"
         "}\n"
         "complete -o default -F _rigproof rigproof\n";
}

// ------------------------------------------------------------------------------------------------------------------
// zsh

// Brackets and colons have a meaning in _arguments.
std::string zsh_escaped(const std::string& text) {
  std::string out;
  for (const char c : text)
    out += (c == '[' || c == ']' || c == ':' || c == '\\') ? std::string("\\") + c : std::string(1, c);
  return out;
}

std::string zsh_values(const Values& values) {
  if (values.names.empty()) return "_files";
  const std::string names = joined(values.names, " ");
  return values.or_file ? "{compadd -- " + names + "; _files}" : "(" + names + ")";
}

std::string zsh_option(const OptionFacts& option) {
  const std::string values = zsh_values(values_of(option));
  if (option.is_positional()) return in_sh("*:" + zsh_escaped(option.names.front()) + ":" + values);
  const std::string tail = "[" + zsh_escaped(option.description) + "]" +
                           (option.value.empty() ? "" : ":" + zsh_escaped(option.value) + ":" + values);
  std::vector<std::string> names = option.names;
  for (std::string& name : names)
    if (!option.value.empty() && name.rfind("--", 0) == 0) name += "=";  // or the value as a word of its own
  return "'*'" + (names.size() == 1 ? names.front() : "{" + joined(names, ",") + "}") + in_sh(tail);
}

std::string zsh_function(const CommandFacts& command) {
  std::string text = joined(command.path, "_");
  text = "_rigproof" + (text.empty() ? "" : "_" + text) + "() {\n";
  if (!command.commands.empty()) {
    text += "  local -a commands=(\n";
    for (const CommandFacts& below : command.commands)
      text += "    " + in_sh(zsh_escaped(below.name()) + ":" + zsh_escaped(below.description)) + "\n";
    text +=
        "  )\n  if (( CURRENT > 2 )); then\n    local function=${0}_${words[2]}\n    shift words; (( CURRENT-- ))\n"
        "    (( $+functions[$function] )) && $function\n    return\n  fi\n"
        "  [[ $PREFIX != -* ]] && _describe command commands && return\n";
  }
  text += "  _arguments";
  for (const OptionFacts& option : command.options) text += " \\\n    " + zsh_option(option);
  return text + "\n}\n";
}

std::string zsh_script(const CommandFacts& program) {
  std::string text = "#compdef rigproof\n# zsh completion of rigproof: a file _rigproof in a folder of $fpath\n";
  for_each(program, [&text](const CommandFacts& command) { text += zsh_function(command); });
  return text + "if [[ $funcstack[1] == _rigproof ]]; then _rigproof \"$@\"; else compdef _rigproof rigproof; fi\n";
}

// -----------------------------------------------------------------------------------------------------------------
// fish

std::string fish_condition(const CommandFacts& command) {
  std::string text = command.path.empty() ? "__fish_use_subcommand" : "";
  for (const std::string& name : command.path)
    text += (text.empty() ? "" : "; and ") + ("__fish_seen_subcommand_from " + name);
  if (!command.path.empty() && !command.commands.empty()) {
    std::vector<std::string> below;
    for (const CommandFacts& one : command.commands) below.push_back(one.name());
    text += "; and not __fish_seen_subcommand_from " + joined(below, " ");
  }
  return text;
}

std::string fish_option(const OptionFacts& option) {
  std::string text;
  for (const std::string& name : option.names)
    text += name.rfind("--", 0) == 0 ? " -l " + name.substr(2) : option.is_positional() ? "" : " -s " + name.substr(1);
  const Values values = values_of(option);
  if (!values.names.empty())
    text +=
        (values.or_file ? option.is_positional() ? " -a " : " -r -a " : " -x -a ") + in_fish(joined(values.names, " "));
  else if (!option.value.empty() && !option.is_positional())
    text += " -r";
  return text + (option.is_positional() ? "" : " -d " + in_fish(option.description));
}

std::string fish_script(const CommandFacts& program) {
  std::string text = "# fish completion of rigproof: `rigproof completion fish | source`\n";
  for_each(program, [&text](const CommandFacts& command) {
    const std::string head = "complete -c rigproof -n " + in_fish(fish_condition(command));
    for (const CommandFacts& below : command.commands)
      text += head + " -f -a " + below.name() + " -d " + in_fish(below.description) + "\n";
    for (const OptionFacts& option : command.options)
      if (!option.is_positional() || !values_of(option).names.empty()) text += head + fish_option(option) + "\n";
  });
  return text;
}

}  // namespace

std::vector<std::string> completion_shells() { return {"bash", "zsh", "fish"}; }

std::string completion_script(const CommandFacts& program, const std::string& shell) {
  if (shell == "bash") return bash_script(program);
  if (shell == "zsh") return zsh_script(program);
  if (shell == "fish") return fish_script(program);
  throw Error(for_message(shell) + ": " + suggestion(shell, completion_shells()));
}

}  // namespace rigproof
