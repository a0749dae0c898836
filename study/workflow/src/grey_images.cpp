#include "rigproof/study/workflow/grey_images.h"

#include <opencv2/core/mat.hpp>
#include <opencv2/imgcodecs.hpp>
#include <vector>

#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/core/folders.h"
#include "rigproof/png/png_reader.h"

namespace rigproof {
namespace {

void make_grey(const std::filesystem::path& file) {
  const std::vector<std::uint8_t> bytes = read_binary_file(file);
  const std::optional<PngHeader> header = read_png_header(bytes);
  if (!header || !header->is_plain() || header->bit_depth != 8 || header->channels() < 3) return;
  auto decoded = decode_png_grey(bytes, *header);
  if (const auto* failure = std::get_if<Unreadable>(&decoded)) throw Error(file.string() + ": " + failure->reason);
  Image8& image = std::get<Image8>(decoded);
  std::vector<std::uint8_t> packed;
  cv::imencode(".png", cv::Mat(image.height, image.width, CV_8UC1, image.pixels.data()), packed,
               {cv::IMWRITE_PNG_COMPRESSION, 6, cv::IMWRITE_PNG_STRATEGY, cv::IMWRITE_PNG_STRATEGY_FILTERED});
  write_file_atomically_unsynced(file, std::string(packed.begin(), packed.end()));
}

}  // namespace

void make_images_grey(const std::filesystem::path& folder,
                      const std::function<bool(std::size_t, std::size_t)>& progress) {
  const auto files = folder_tree(folder);
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (files[i].is_regular_file() && files[i].path().extension() == ".png") make_grey(files[i].path());
    if (progress && !progress(i + 1, files.size())) throw Error("interrupted", ExitCode::kTryAgain);
  }
}

}  // namespace rigproof
