// The files of page/, as the build places them into the program.
#pragma once

#include <string_view>

namespace rigproof::page_files {

extern const std::string_view page;      ///< report.html, with {{names}} of what goes where
extern const std::string_view style;     ///< report.css
extern const std::string_view script;    ///< the scripts of page/js, one after the other
extern const std::string_view echarts;   ///< third_party/echarts.min.js
extern const std::string_view three;     ///< third_party/three.min.js
extern const std::string_view licences;  ///< of both

}  // namespace rigproof::page_files
