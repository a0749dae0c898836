// What stands at the head of every export that has comments.
#pragma once

#include <string>
#include <vector>

#include "rigproof/study/export/export.h"

namespace rigproof::exporting {

/// Where it is from, then remarks_of(), a line each.
std::vector<std::string> head_lines(const ExportJob& job);
/// The same with how axes of links were read.
std::vector<std::string> tree_head_lines(const ExportJob& job);
/// "# line", each with its line feed.
std::string hash_comment(const std::vector<std::string>& lines);
/// One XML comment, with its line feed.
std::string xml_comment(const std::vector<std::string>& lines, const std::string& indent);
/// A text as the value of an attribute in double quotes.
std::string xml_attribute(const std::string& text);
/// Letters, digits and "_" alone, which every language takes for a name.
std::string identifier(const std::string& name);

}  // namespace rigproof::exporting
