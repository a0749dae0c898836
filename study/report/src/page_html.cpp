#include <openssl/evp.h>

#include <array>
#include <utility>

#include "page_files.h"
#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/study/report/page.h"

namespace rigproof {
namespace {

// Inside of <script type="application/json"> only "</script" and "<!--" mean anything to a browser; JSON may write any
// character of a text as an escape, and outside of texts it has no "<".
std::string as_element_content(const std::string& json) {
  std::string text;
  text.reserve(json.size());
  for (const char c : json) {
    if (c == '<')
      text += "\\u003c";
    else
      text += c;
  }
  return text;
}

std::string as_html(const std::string& plain) {
  std::string text;
  for (const char c : plain) {
    switch (c) {
      case '<':
        text += "&lt;";
        break;
      case '>':
        text += "&gt;";
        break;
      case '&':
        text += "&amp;";
        break;
      case '"':
        text += "&quot;";
        break;
      default:
        text += c;
    }
  }
  return text;
}

int hex_digit(char c) { return c <= '9' ? c - '0' : c - 'a' + 10; }

// 'sha256-..' as a content security policy names a script.
std::string script_hash(const std::string& script) {
  const std::string hex = sha256_hex(script);
  std::array<unsigned char, 32> bytes{};
  for (std::size_t i = 0; i < bytes.size(); ++i)
    bytes[i] = static_cast<unsigned char>(16 * hex_digit(hex[2 * i]) + hex_digit(hex[2 * i + 1]));
  std::array<unsigned char, 45> text{};
  const int length = EVP_EncodeBlock(text.data(), bytes.data(), static_cast<int>(bytes.size()));
  return "'sha256-" + std::string(text.begin(), text.begin() + length) + "'";
}

// Replaces {{name}} by its value, once: what is placed in is not looked at again.
std::string filled(std::string_view page, const std::vector<std::pair<std::string, std::string>>& values) {
  std::string text;
  std::size_t at = 0;
  for (std::size_t open = page.find("{{"); open != std::string_view::npos; open = page.find("{{", at)) {
    const std::size_t close = page.find("}}", open);
    const std::string name(page.substr(open + 2, close - open - 2));
    text += page.substr(at, open - at);
    const auto value = std::find_if(values.begin(), values.end(), [&](const auto& v) { return v.first == name; });
    if (value == values.end()) throw Error("report.html: there is no {{" + name + "}}");
    text += value->second;
    at = close + 2;
  }
  return text + std::string(page.substr(at));
}

}  // namespace

std::string page_html(const PageContent& content) {
  const std::string echarts(page_files::echarts), three(page_files::three), script(page_files::script);
  const std::string policy = "default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src " +
                             script_hash(echarts) + " " + script_hash(three) + " " + script_hash(script) +
                             "; base-uri 'none'; form-action 'none'";
  return filled(page_files::page, {{"policy", policy},
                                   {"title", as_html(content.title)},
                                   {"style", std::string(page_files::style)},
                                   {"data", as_element_content(content.data)},
                                   {"images", as_element_content(content.images)},
                                   {"licences", as_html(std::string(page_files::licences))},
                                   {"echarts", echarts},
                                   {"three", three},
                                   {"script", script}});
}

}  // namespace rigproof
