#include "unpack.h"

#include <isa-l/crc.h>
#include <lz4frame.h>
#include <zstd.h>

#include <fstream>
#include <vector>

#include "bag_file.h"
#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/core/text.h"

namespace rigproof {

char* RawBuffer::reserve(std::size_t size) {
  if (size > capacity_) {
    bytes_.reset();
    bytes_.reset(new char[size]);
    capacity_ = size;
  }
  return bytes_.get();
}

struct Unpacker::Contexts {
  std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> zstd{ZSTD_createDCtx(), &ZSTD_freeDCtx};
  std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> lz4{nullptr, &LZ4F_freeDecompressionContext};
};

Unpacker::Unpacker() : contexts_(std::make_unique<Contexts>()) {
  LZ4F_dctx* lz4 = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&lz4, LZ4F_VERSION)) == 0U) contexts_->lz4.reset(lz4);
}

Unpacker::~Unpacker() = default;

std::string Unpacker::unpack_zstd(std::string_view packed, char* to, std::size_t size) {
  const std::size_t written = ZSTD_decompressDCtx(contexts_->zstd.get(), to, size, packed.data(), packed.size());
  if (ZSTD_isError(written) != 0U) return std::string("zstd: ") + ZSTD_getErrorName(written);
  return written == size ? "" : "zstd: unpacks to " + std::to_string(written) + " bytes, not " + std::to_string(size);
}

std::string Unpacker::unpack_lz4(std::string_view packed, char* to, std::size_t size) {
  LZ4F_resetDecompressionContext(contexts_->lz4.get());
  std::size_t read = 0, written = 0;
  while (read < packed.size()) {
    std::size_t source = packed.size() - read, target = size - written;
    const std::size_t hint =
        LZ4F_decompress(contexts_->lz4.get(), to + written, &target, packed.data() + read, &source, nullptr);
    if (LZ4F_isError(hint) != 0U) return std::string("lz4: ") + LZ4F_getErrorName(hint);
    read += source;
    written += target;
    if (source == 0 && target == 0) return "lz4: unpacks to more than " + std::to_string(size) + " bytes";
  }
  return written == size ? "" : "lz4: unpacks to " + std::to_string(written) + " bytes, not " + std::to_string(size);
}

bool is_zstd(std::string_view bytes) { return bytes.substr(0, 4) == "\x28\xB5\x2F\xFD"; }

namespace {

class ZstdStream {
 public:
  /// Feeds packed bytes; hands what comes out to `take`. Returns what is wrong, or nothing.
  template <typename Take>
  std::string feed(std::string_view packed, const Take& take) {
    ZSTD_inBuffer input{packed.data(), packed.size(), 0};
    bool full = true;
    while (input.pos < input.size || (full && missing_ != 0)) {
      ZSTD_outBuffer output{out_.data(), out_.size(), 0};
      missing_ = ZSTD_decompressStream(stream_.get(), &output, &input);
      if (ZSTD_isError(missing_) != 0U) return std::string("zstd: ") + ZSTD_getErrorName(missing_);
      take(std::string_view(out_.data(), output.pos));
      full = output.pos == output.size;
    }
    return "";
  }
  bool is_whole() const { return missing_ == 0; }

 private:
  std::unique_ptr<ZSTD_DStream, decltype(&ZSTD_freeDStream)> stream_{ZSTD_createDStream(), &ZSTD_freeDStream};
  std::vector<char> out_ = std::vector<char>(ZSTD_DStreamOutSize());
  std::size_t missing_ = 1;
};

}  // namespace

std::string unpack_zstd_message(std::string_view packed) {
  std::string bytes;
  ZstdStream stream;
  const std::string wrong = stream.feed(packed, [&bytes](std::string_view piece) {
    bytes += piece;
    if (bytes.size() > kMaxPiece) throw Error("unpacks to more than " + megabytes(static_cast<double>(kMaxPiece)));
  });
  if (!wrong.empty()) throw Error(wrong);
  if (!stream.is_whole()) throw Error("zstd: ends early");
  return bytes;
}

void unpack_zstd_file(const std::filesystem::path& from, const std::filesystem::path& to) {
  std::ifstream input(from, std::ios::binary);
  std::ofstream output(to, std::ios::binary);
  ZstdStream stream;
  std::vector<char> piece(1U << 20U);
  while (input) {
    input.read(piece.data(), static_cast<std::streamsize>(piece.size()));
    const auto size = static_cast<std::size_t>(input.gcount());
    if (size == 0) break;
    const std::string wrong = stream.feed({piece.data(), size}, [&output](std::string_view unpacked) {
      output.write(unpacked.data(), static_cast<std::streamsize>(unpacked.size()));
    });
    if (!wrong.empty()) throw Error(from.string() + ": " + wrong + "; the file is damaged");
    if (!output) throw Error(to.string() + ": cannot be written; is the disk full?");
  }
  if (!stream.is_whole()) throw Error(from.string() + ": ends early; the file is not whole");
  output.close();
  if (!output) throw Error(to.string() + ": cannot be written; is the disk full?");
}

std::uint32_t crc32_of(std::string_view bytes, std::uint32_t before) {
  return crc32_gzip_refl(before, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
}

}  // namespace rigproof
