#include "command_tree.h"

#include <algorithm>

#include "rigproof/core/error.h"
#include "rigproof/core/text.h"

namespace rigproof {
namespace {

// "INT:INT in [0 - 1024]" is a number, "TEXT:{depth,images}" a choice of two.
std::vector<std::string> choices_in(const std::string& type) {
  const std::size_t open = type.find('{'), close = type.rfind('}');
  std::vector<std::string> choices;
  if (open == std::string::npos || close == std::string::npos) return choices;
  for (std::size_t at = open + 1; at < close;) {
    const std::size_t end = std::min(type.find(',', at), close);
    choices.push_back(type.substr(at, end - at));
    at = end + 1;
  }
  return choices;
}

OptionFacts facts_of(const CLI::Option& option) {
  OptionFacts facts;
  for (const std::string& name : option.get_snames()) facts.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) facts.names.push_back("--" + name);
  if (facts.names.empty()) facts.names.push_back(option.get_name(true));
  facts.description = option.get_description();
  if (option.get_items_expected_max() > 0)
    facts.value = option.get_type_name().substr(0, option.get_type_name().find(':'));
  facts.choices = choices_in(option.get_type_name());
  return facts;
}

CommandFacts facts_of(const CLI::App& app, std::vector<std::string> path) {
  CommandFacts facts;
  facts.path = std::move(path);
  facts.description = app.get_description();
  facts.group = app.get_group();
  facts.footer = app.get_footer();
  for (const CLI::Option* option : app.get_options()) facts.options.push_back(facts_of(*option));
  for (const CLI::App* command : app.get_subcommands(nullptr)) {
    std::vector<std::string> below = facts.path;
    below.push_back(command->get_name());
    facts.commands.push_back(facts_of(*command, std::move(below)));
  }
  return facts;
}

std::vector<std::string> long_names(const CommandFacts& command) {
  std::vector<std::string> names;
  for (const OptionFacts& option : command.options)
    for (const std::string& name : option.names)
      if (name.rfind("--", 0) == 0) names.push_back(name);
  return names;
}

std::vector<std::string> command_names(const CommandFacts& command) {
  std::vector<std::string> names;
  for (const CommandFacts& below : command.commands) names.push_back(below.name());
  return names;
}

const CommandFacts* find_command(const CommandFacts& command, const std::string& name) {
  for (const CommandFacts& below : command.commands)
    if (below.name() == name) return &below;
  return nullptr;
}

std::string words_of(const CommandFacts& command) {
  return "rigproof" + (command.path.empty() ? "" : " " + joined(command.path, " "));
}

void check_option(const CommandFacts& command, const std::string& argument, Problems* problems) {
  const std::vector<std::string> known = long_names(command);
  const std::string name = argument.substr(0, argument.find('='));
  if (std::find(known.begin(), known.end(), name) != known.end()) return;
  const std::optional<std::string> near = nearest_name(name, known);
  problems->add({"", 0, "", for_message(name),
                 "there is no such option; " + (near ? "did you mean \"" + *near + "\"? " : std::string()) + "`" +
                     words_of(command) + " --help` lists them"});
}

}  // namespace

CommandFacts facts_of(const CLI::App& app) { return facts_of(app, {}); }

void check_names(const CLI::App& app, const std::vector<std::string>& arguments) {
  const CommandFacts program = facts_of(app);
  const CommandFacts* command = &program;
  Problems problems;
  for (const std::string& argument : arguments) {
    if (argument == "--") break;
    if (argument.rfind("--", 0) == 0) {
      check_option(*command, argument, &problems);
    } else if (!command->commands.empty() && !argument.empty() && argument[0] != '-') {
      const CommandFacts* below = find_command(*command, argument);
      if (below == nullptr)
        throw Error("\"" + for_message(argument) + "\": there is no such command; " +
                    suggestion(argument, command_names(*command)));
      command = below;
    }
  }
  problems.throw_if_any();
}

}  // namespace rigproof
