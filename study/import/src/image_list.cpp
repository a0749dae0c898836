#include "image_list.h"

#include <algorithm>
#include <map>
#include <optional>

#include "rigproof/core/files.h"
#include "rigproof/core/folders.h"
#include "rigproof/core/text.h"
#include "rigproof/formats/trajectory.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

const std::vector<std::string> kImageFolders = {"color", "image", "images", "data", "rgb", "."};

bool is_image(const fs::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  return extension == ".png" || extension == ".jpg" || extension == ".jpeg";
}

std::vector<fs::path> images_in(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : folder_entries(folder))
    if (is_image(entry.path())) files.push_back(entry.path());
  return files;
}

// The first of the usual folders that holds images.
std::optional<fs::path> image_folder(const fs::path& folder) {
  for (const std::string& name : kImageFolders)
    if (!images_in(folder / name).empty()) return (folder / name).lexically_normal();
  return std::nullopt;
}

// "1699999.123" is seconds, 16 digits and more are nanoseconds.
std::optional<double> stamp_of(std::string_view text) {
  if (text.find_first_not_of("0123456789.") != std::string_view::npos) return std::nullopt;
  const std::optional<double> value = parse_number(text);
  if (!value) return std::nullopt;
  if (text.find('.') != std::string_view::npos) return value;
  return text.size() >= 16 ? std::optional<double>(*value * 1e-9) : std::nullopt;
}

// Lines of a stamp and a file, in either order; stamps of a list may be plain numbers.
std::map<std::string, double> stamps_of_list(const fs::path& list, Problems* problems) {
  std::map<std::string, double> stamps;
  const std::string text = read_text_file(list);
  std::string_view rest = text;
  for (int line = 1; !rest.empty(); ++line) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    const std::vector<std::string_view> fields = fields_of(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
    if (fields.empty() || fields[0].front() == '#' || fields.size() < 2) continue;
    const std::size_t file = is_image(fs::path(std::string(fields[0]))) ? 0 : 1;
    const std::string_view number = fields[1 - file];
    const std::optional<double> stamp = stamp_of(number) ? stamp_of(number) : parse_number(number);
    if (stamp)
      stamps[fs::path(std::string(fields[file])).filename().string()] = *stamp;
    else if (line > 1)  // the first line may be a header
      problems->add({list.string(), line, "", for_message(number),
                     "must be a stamp: seconds, or nanoseconds with 16 digits and more"});
  }
  return stamps;
}

std::optional<fs::path> find_list(const fs::path& folder) {
  for (const char* name : {"frames.csv", "data.csv", "rgb.txt"}) {
    std::error_code ignored;
    if (fs::is_regular_file(folder / name, ignored)) return folder / name;
  }
  return std::nullopt;
}

fs::path depth_beside(const fs::path& folder, const fs::path& color) {
  std::error_code ignored;
  const fs::path depth = folder / "depth" / (color.stem().string() + ".png");
  return fs::is_regular_file(depth, ignored) ? depth : fs::path();
}

}  // namespace

bool has_images(const fs::path& folder) { return image_folder(folder).has_value(); }

std::vector<StampedFile> list_images(const fs::path& folder, Problems* problems) {
  std::vector<StampedFile> files;
  const fs::path images = image_folder(folder).value();
  const std::optional<fs::path> list = find_list(folder);
  const std::map<std::string, double> listed = list ? stamps_of_list(*list, problems) : std::map<std::string, double>();
  std::size_t without = 0;
  std::string first_without;
  for (const fs::path& image : images_in(images)) {
    std::optional<double> stamp;
    if (const auto found = listed.find(image.filename().string()); found != listed.end())
      stamp = found->second;
    else if (!list)
      stamp = stamp_of(image.stem().string());
    if (stamp)
      files.push_back({*stamp, image, depth_beside(folder, image)});
    else if (without++ == 0)
      first_without = image.filename().string();
  }
  if (without > 0)
    problems->add(
        {images.string(), 0, "", "",
         std::to_string(without) + " images have no stamp, the first: " + for_message(first_without) +
             "; name them by it (1699999.123.png in seconds, or 16 digits and more in nanoseconds), or give a "
             "list frames.csv with lines of file,stamp_s"});
  std::stable_sort(files.begin(), files.end(),
                   [](const StampedFile& a, const StampedFile& b) { return a.stamp_s < b.stamp_s; });
  return files;
}

}  // namespace rigproof
