#include <algorithm>

#include "rigproof/core/bag_name.h"
#include "rigproof/core/error.h"
#include "rigproof/core/folders.h"
#include "rigproof/core/text.h"
#include "rigproof/formats/format.h"

namespace rigproof {

namespace fs = std::filesystem;

Format run_format();
Format recording_format();
Format memroc_format();
Format observations_format();
Format euroc_format();
Format opencv_format();
Format mrcal_format();
Format mcalib_format();
Format colmap_format();

// A format is a line here. The order decides where a folder could be of several.
const std::vector<Format>& formats() {
  static const std::vector<Format> all = {
      run_format(),    recording_format(), memroc_format(), observations_format(), euroc_format(),
      opencv_format(), mrcal_format(),     mcalib_format(), colmap_format(),
  };
  return all;
}

namespace {

// The others are only written.
std::vector<Format> formats_that_are_read() {
  std::vector<Format> read;
  for (const Format& format : formats())
    if (format.read != nullptr) read.push_back(format);
  return read;
}

// What a folder holds, for a message.
std::string contents_of(const fs::path& folder) {
  constexpr std::size_t kMost = 8;
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end && names.size() < 1000; it.increment(error))
    names.push_back(for_message(it->path().filename().string()));
  if (error) return "cannot be listed (" + error.message() + ")";
  if (names.empty()) return "is empty";
  std::sort(names.begin(), names.end());
  const std::size_t count = names.size();
  names.resize(std::min(count, kMost));
  return "holds " + joined(names) + (count > kMost ? " and " + std::to_string(count - kMost) + " more" : "");
}

// "a, b and c"
std::string enumerated(const std::vector<std::string>& words, const std::string& last_word) {
  if (words.size() < 2) return joined(words);
  return joined({words.begin(), words.end() - 1}) + last_word + words.back();
}

// The name of observations.json says what it is.
std::string looked_for() {
  std::vector<std::string> words;
  for (const Format& format : formats_that_are_read())
    words.push_back(format.marker + (format.suffix.empty() ? " (" + format.what + ")" : ""));
  return enumerated(words, " and ");
}

const Format& format_of_file(const fs::path& file) {
  std::vector<std::string> known;
  for (const Format& format : formats()) {
    if (!format.suffix.empty() && file.extension() == format.suffix) return format;
    if (!format.suffix.empty()) known.push_back(format.what + " (" + format.suffix + ")");
  }
  refuse_bag(file);
  for (const Format& format : formats_that_are_read())
    if (file.filename() == format.marker) throw Error(file.string() + ": give the folder that holds this file");
  throw Error(file.string() + ": a file is expected to be " + enumerated(known, " or ") +
              "; everything else is a folder");
}

}  // namespace

const Format& detect_format(const fs::path& path) {
  std::error_code ignored;
  if (fs::is_regular_file(path, ignored)) return format_of_file(path);
  if (!fs::is_directory(path, ignored)) throw Error(path.string() + ": no such file or folder");
  for (const Format& format : formats())
    if (format.read != nullptr && format.detect(path)) return format;
  refuse_bag(path);
  throw Error(path.string() + ": not an input: " + looked_for() + " were looked for; the folder " + contents_of(path));
}

Input open_input(const fs::path& path) {
  const Format& format = detect_format(path);
  Input input = format.read(path);
  input.format = &format;
  input.path = path;
  return input;
}

std::vector<std::string> writable_formats() {
  std::vector<std::string> names;
  for (const Format& format : formats())
    if (format.write != nullptr) names.push_back(format.name);
  return names;
}

const Format& writable_format(const std::string& name) {
  for (const Format& format : formats())
    if (format.write != nullptr && format.name == name) return format;
  throw Error("format: \"" + for_message(name) + "\": " + suggestion(name, writable_formats()));
}

std::string inputs_in_words(bool with_images_only) {
  std::vector<std::string> words;
  for (const Format& format : formats_that_are_read())
    if (format.has_images || !with_images_only) words.push_back(format.given_as);
  return enumerated(words, ", or ");
}

bool has_file(const fs::path& folder, const std::string& name) {
  std::error_code ignored;
  return fs::is_regular_file(folder / name, ignored);
}

void copy_file_into(const fs::path& from, const fs::path& to) {
  create_folder(to.parent_path());
  std::error_code error;
  fs::copy_file(from, to, fs::copy_options::overwrite_existing, error);
  if (error) throw_system_error(to, "copy " + from.string() + " there", error.value());
}

}  // namespace rigproof
