// A file: header, driver's name, then colour, depth and the imager's picture. Pictures are filtered like a PNG ("up")
// and deflated. The bits of the depth are predicted from the two rows above, since depth is nearly linear in a picture
// of a plane, and the remainders are stored byte plane by byte plane, each behind its size: deflated, or as it is where
// that would hardly be smaller but takes longest to read.
#include "clean_cache.h"

#include <isa-l/crc.h>
#include <isa-l/igzip_lib.h>

#include <array>
#include <cstring>
#include <fstream>
#include <memory>

#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/core/vector_clones.h"

namespace rigproof {
namespace {

constexpr char kMagic[8] = {'R', 'P', 'C', 'L', 'E', 'A', 'N', '3'};
constexpr std::uint32_t kMaxSide = 32768, kMaxName = 4096;
constexpr std::streamoff kMaxBytes = 512 << 20;
constexpr std::size_t kPlanes = 4;
// A plane that deflates to more than this is kept as it is.
constexpr double kHardlySmaller = 0.8;

struct Header {
  char magic[8];
  std::uint32_t width, height, channels;
  std::uint32_t depth_width, depth_height;  ///< 0 = there is none
  std::uint32_t name_bytes, color_bytes, depth_bytes;
  std::uint32_t imager_bytes;  ///< 0 = there is none
  std::uint32_t checksum;      ///< of all that follows
};

std::uint32_t checksum_of(const char* bytes, std::size_t count) {
  return crc32_gzip_refl(0, reinterpret_cast<const unsigned char*>(bytes), count);
}

RIGPROOF_VECTOR_CLONES
void subtract(const std::uint8_t* row, const std::uint8_t* above, std::size_t count, std::uint8_t* out) {
  for (std::size_t i = 0; i < count; ++i) out[i] = static_cast<std::uint8_t>(row[i] - above[i]);
}

RIGPROOF_VECTOR_CLONES
void add(const std::uint8_t* above, std::size_t count, std::uint8_t* row) {
  for (std::size_t i = 0; i < count; ++i) row[i] = static_cast<std::uint8_t>(row[i] + above[i]);
}

std::vector<std::uint8_t> filtered(const Image8& color) {
  std::vector<std::uint8_t> bytes(color.pixels.size());
  const std::size_t length = color.row_length();
  std::copy_n(color.pixels.data(), std::min(length, bytes.size()), bytes.data());
  for (int y = 1; y < color.height; ++y)
    subtract(color.row(y), color.row(y - 1), length, bytes.data() + static_cast<std::size_t>(y) * length);
  return bytes;
}

void unfilter(Image8* color) {
  for (int y = 1; y < color->height; ++y) add(color->row(y - 1), color->row_length(), color->row(y));
}

// Remainders of small size, of either sign, become small numbers: 0, -1, 1, -2, ..
RIGPROOF_VECTOR_CLONES
void split_row(const std::uint32_t* row, const std::uint32_t* above, const std::uint32_t* two_above, std::size_t count,
               std::uint8_t* const planes[4]) {
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t remainder = row[i] - (2U * above[i] - two_above[i]);
    const std::uint32_t folded = (remainder << 1U) ^ (0U - (remainder >> 31U));
    planes[0][i] = static_cast<std::uint8_t>(folded);
    planes[1][i] = static_cast<std::uint8_t>(folded >> 8U);
    planes[2][i] = static_cast<std::uint8_t>(folded >> 16U);
    planes[3][i] = static_cast<std::uint8_t>(folded >> 24U);
  }
}

RIGPROOF_VECTOR_CLONES
void join_row(const std::uint8_t* const planes[4], const std::uint32_t* above, const std::uint32_t* two_above,
              std::size_t count, std::uint32_t* row) {
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t folded =
        static_cast<std::uint32_t>(planes[0][i]) | (static_cast<std::uint32_t>(planes[1][i]) << 8U) |
        (static_cast<std::uint32_t>(planes[2][i]) << 16U) | (static_cast<std::uint32_t>(planes[3][i]) << 24U);
    const std::uint32_t remainder = (folded >> 1U) ^ (0U - (folded & 1U));
    row[i] = remainder + (2U * above[i] - two_above[i]);
  }
}

std::vector<std::uint8_t> split_depth(const ImageF& depth) {
  const auto width = static_cast<std::size_t>(depth.width), height = static_cast<std::size_t>(depth.height);
  std::vector<std::uint32_t> bits(width * (height + 2), 0U);  // two rows of zeros above
  std::memcpy(bits.data() + 2 * width, depth.pixels.data(), width * height * sizeof(float));
  std::vector<std::uint8_t> bytes(4 * width * height);
  for (std::size_t y = 0; y < height; ++y) {
    std::uint8_t* planes[4];
    for (std::size_t k = 0; k < 4; ++k) planes[k] = bytes.data() + (k * height + y) * width;
    const std::uint32_t* two_above = bits.data() + y * width;
    split_row(two_above + 2 * width, two_above + width, two_above, width, planes);
  }
  return bytes;
}

void join_depth(const std::array<const std::uint8_t*, kPlanes>& bytes, ImageF* depth) {
  const auto width = static_cast<std::size_t>(depth->width), height = static_cast<std::size_t>(depth->height);
  std::vector<std::uint32_t> rows[3];
  for (std::vector<std::uint32_t>& row : rows) row.assign(width, 0U);
  for (std::size_t y = 0; y < height; ++y) {
    const std::uint8_t* planes[kPlanes];
    for (std::size_t k = 0; k < kPlanes; ++k) planes[k] = bytes[k] + y * width;
    std::vector<std::uint32_t>& row = rows[y % 3];
    join_row(planes, rows[(y + 2) % 3].data(), rows[(y + 1) % 3].data(), width, row.data());
    std::memcpy(depth->pixels.data() + y * width, row.data(), width * sizeof(float));
  }
}

// Of a new size, in the memory that it has.
template <typename T>
void resize(int width, int height, int channels, Image<T>* image) {
  image->width = width;
  image->height = height;
  image->channels = channels;
  image->pixels.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) *
                       static_cast<std::size_t>(channels));
}

bool read_file(const std::filesystem::path& file, std::vector<std::uint8_t>* bytes) {
  std::ifstream in(file, std::ios::binary | std::ios::ate);
  const std::streamoff size = in ? static_cast<std::streamoff>(in.tellg()) : -1;
  if (size < 0 || size > kMaxBytes) return false;
  bytes->resize(static_cast<std::size_t>(size));
  in.seekg(0);
  return static_cast<bool>(in.read(reinterpret_cast<char*>(bytes->data()), size));
}

std::string deflated(std::uint8_t* bytes, std::size_t count) {
  std::vector<std::uint8_t> buffer(ISAL_DEF_LVL1_DEFAULT);
  std::string out(count + count / 8 + 4096, '\0');
  isal_zstream stream{};
  isal_deflate_stateless_init(&stream);
  stream.level = 1;
  stream.level_buf = buffer.data();
  stream.level_buf_size = static_cast<std::uint32_t>(buffer.size());
  stream.end_of_stream = 1;
  stream.next_in = bytes;
  stream.avail_in = static_cast<std::uint32_t>(count);
  stream.next_out = reinterpret_cast<std::uint8_t*>(out.data());
  stream.avail_out = static_cast<std::uint32_t>(out.size());
  const int status = isal_deflate_stateless(&stream);
  if (status != COMP_OK) throw Error("ISA-L deflate failed with status " + std::to_string(status));
  out.resize(stream.total_out);
  return out;
}

bool inflate_into(const std::uint8_t* in, std::size_t count, std::uint8_t* out, std::size_t expected) {
  const auto state = std::make_unique<inflate_state>();
  isal_inflate_init(state.get());
  state->next_in = const_cast<std::uint8_t*>(in);
  state->avail_in = static_cast<std::uint32_t>(count);
  state->next_out = out;
  state->avail_out = static_cast<std::uint32_t>(expected);
  return isal_inflate_stateless(state.get()) == ISAL_DECOMP_OK && state->total_out == expected;
}

std::string encode_depth(const ImageF& depth) {
  std::vector<std::uint8_t> planes = split_depth(depth);
  const std::size_t size = planes.size() / kPlanes;
  std::string text;
  for (std::size_t k = 0; k < kPlanes; ++k) {
    std::uint8_t* plane = planes.data() + k * size;
    std::string packed = deflated(plane, size);
    if (static_cast<double>(packed.size()) > kHardlySmaller * static_cast<double>(size))
      packed.assign(reinterpret_cast<const char*>(plane), size);
    const auto bytes = static_cast<std::uint32_t>(packed.size());
    text.append(reinterpret_cast<const char*>(&bytes), sizeof bytes);
    text += packed;
  }
  return text;
}

// @param scratch memory for the planes that are deflated
bool decode_depth(const std::uint8_t* bytes, std::size_t count, std::vector<std::uint8_t>* scratch, ImageF* depth) {
  const std::size_t size = depth->pixels.size();
  scratch->resize(kPlanes * size);
  std::array<const std::uint8_t*, kPlanes> planes{};
  for (std::size_t k = 0; k < kPlanes; ++k) {
    std::uint32_t packed = 0;
    if (count < sizeof packed) return false;
    std::memcpy(&packed, bytes, sizeof packed);
    bytes += sizeof packed;
    count -= sizeof packed;
    if (packed > count) return false;
    std::uint8_t* unpacked = scratch->data() + k * size;
    planes[k] = packed == size ? bytes : unpacked;
    if (packed != size && !inflate_into(bytes, packed, unpacked, size)) return false;
    bytes += packed;
    count -= packed;
  }
  join_depth(planes, depth);
  return count == 0;
}

bool is_sound(const Header& header, std::size_t bytes) {
  const std::uint64_t expected =
      sizeof(Header) + std::uint64_t{header.name_bytes} + header.color_bytes + header.depth_bytes + header.imager_bytes;
  return std::memcmp(header.magic, kMagic, sizeof kMagic) == 0 && header.width >= 1 && header.width <= kMaxSide &&
         header.height >= 1 && header.height <= kMaxSide && (header.channels == 1 || header.channels == 3) &&
         header.depth_width <= kMaxSide && header.depth_height <= kMaxSide &&
         (header.depth_width == 0) == (header.depth_height == 0) && header.name_bytes <= kMaxName && expected == bytes;
}

}  // namespace

std::string encode_clean_frame(const CleanFrame& frame) {
  std::vector<std::uint8_t> color_bytes = filtered(frame.color);
  const std::string color = deflated(color_bytes.data(), color_bytes.size());
  const std::string depth = frame.depth_m.empty() ? "" : encode_depth(frame.depth_m);
  std::string imager;
  if (!frame.imager.empty()) {
    std::vector<std::uint8_t> imager_bytes = filtered(frame.imager);
    imager = deflated(imager_bytes.data(), imager_bytes.size());
  }
  Header header{};
  std::memcpy(header.magic, kMagic, sizeof kMagic);
  header.width = static_cast<std::uint32_t>(frame.color.width);
  header.height = static_cast<std::uint32_t>(frame.color.height);
  header.channels = static_cast<std::uint32_t>(frame.color.channels);
  header.depth_width = frame.depth_m.empty() ? 0 : static_cast<std::uint32_t>(frame.depth_m.width);
  header.depth_height = frame.depth_m.empty() ? 0 : static_cast<std::uint32_t>(frame.depth_m.height);
  header.name_bytes = static_cast<std::uint32_t>(frame.gl_renderer.size());
  header.color_bytes = static_cast<std::uint32_t>(color.size());
  header.depth_bytes = static_cast<std::uint32_t>(depth.size());
  header.imager_bytes = static_cast<std::uint32_t>(imager.size());
  const std::string body = frame.gl_renderer + color + depth + imager;
  header.checksum = checksum_of(body.data(), body.size());
  return std::string(reinterpret_cast<const char*>(&header), sizeof header) + body;
}

bool decode_clean_frame(const std::vector<std::uint8_t>& bytes, std::vector<std::uint8_t>* scratch, CleanFrame* frame) {
  Header header{};
  if (bytes.size() < sizeof header) return false;
  std::memcpy(&header, bytes.data(), sizeof header);
  const std::uint8_t* body = bytes.data() + sizeof header;
  if (!is_sound(header, bytes.size()) ||
      header.checksum != checksum_of(reinterpret_cast<const char*>(body), bytes.size() - sizeof header))
    return false;
  frame->gl_renderer.assign(reinterpret_cast<const char*>(body), header.name_bytes);
  const int width = static_cast<int>(header.width), height = static_cast<int>(header.height);
  resize(width, height, static_cast<int>(header.channels), &frame->color);
  const std::uint8_t* color = body + header.name_bytes;
  if (!inflate_into(color, header.color_bytes, frame->color.pixels.data(), frame->color.pixels.size())) return false;
  unfilter(&frame->color);
  frame->imager = Image8();
  if (header.depth_width == 0) {
    frame->depth_m = ImageF();
    return true;
  }
  const int depth_width = static_cast<int>(header.depth_width), depth_height = static_cast<int>(header.depth_height);
  resize(depth_width, depth_height, 1, &frame->depth_m);
  const std::uint8_t* depth = color + header.color_bytes;
  if (!decode_depth(depth, header.depth_bytes, scratch, &frame->depth_m)) return false;
  if (header.imager_bytes == 0) return true;
  resize(depth_width, depth_height, 1, &frame->imager);
  std::vector<std::uint8_t>& pixels = frame->imager.pixels;
  if (!inflate_into(depth + header.depth_bytes, header.imager_bytes, pixels.data(), pixels.size())) return false;
  unfilter(&frame->imager);
  return true;
}

std::filesystem::path CleanCache::file_of(const std::string& key) const {
  return folder_ / key.substr(0, 2) / (key.substr(2) + ".clean");
}

std::string CleanCache::renderer_of(const std::string& key) const {
  std::ifstream in(file_of(key), std::ios::binary);
  Header header{};
  if (!in.read(reinterpret_cast<char*>(&header), sizeof header)) return "";
  if (std::memcmp(header.magic, kMagic, sizeof kMagic) != 0 || header.name_bytes > kMaxName) return "";
  std::string name(header.name_bytes, '\0');
  return in.read(name.data(), static_cast<std::streamsize>(name.size())) ? name : "";
}

bool CleanCache::load(const std::string& key, CleanFrame* frame) const {
  std::error_code error;
  const std::filesystem::path file = file_of(key);
  return std::filesystem::is_regular_file(file, error) && read_file(file, &file_) &&
         decode_clean_frame(file_, &planes_, frame);
}

void CleanCache::save(const std::string& key, const CleanFrame& frame) const {
  write_file_atomically_unsynced(file_of(key), encode_clean_frame(frame));
}

}  // namespace rigproof
