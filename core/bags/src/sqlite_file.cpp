// rosbag2's SQLite files: tables topics (id, name, type, serialization_format) and messages (topic_id, timestamp,
// data), the same in all of their schema versions; what later ones add is not needed.
#include <sqlite3.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <limits>
#include <map>

#include "bag_file.h"
#include "rigproof/core/error.h"
#include "rigproof/core/text.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

std::string uri_of(const fs::path& file, bool immutable) {
  std::string uri = "file:";
  static constexpr char kHex[] = "0123456789ABCDEF";
  for (const char c : fs::absolute(file).string()) {
    const auto byte = static_cast<unsigned char>(c);
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '/' ||
                       c == '.' || c == '_' || c == '-';
    if (plain)
      uri += c;
    else
      uri += {'%', kHex[byte >> 4U], kHex[byte & 15U]};
  }
  return uri + (immutable ? "?immutable=1" : "?mode=ro");
}

class Statement {
 public:
  Statement(sqlite3* database, const std::string& sql) {
    sqlite3_prepare_v2(database, sql.c_str(), -1, &statement_, nullptr);
  }
  ~Statement() { sqlite3_finalize(statement_); }
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  bool is_good() const { return statement_ != nullptr; }
  sqlite3_stmt* get() const { return statement_; }
  std::int64_t integer(int column) const { return sqlite3_column_int64(statement_, column); }
  std::string_view bytes(int column) const {
    const void* data = sqlite3_column_blob(statement_, column);
    const int size = sqlite3_column_bytes(statement_, column);
    return data == nullptr ? std::string_view()
                           : std::string_view(static_cast<const char*>(data), static_cast<std::size_t>(size));
  }

 private:
  sqlite3_stmt* statement_ = nullptr;
};

class SqliteFile : public BagFile {
 public:
  explicit SqliteFile(const fs::path& file) : file_(file) {
    if (!find_file()) throw Error(file.string() + ": " + std::strerror(errno));
    open();
  }

  std::uint64_t size_bytes() const override { return size_; }

  void read(std::uint32_t index, const BagSink& sink) override {
    std::string wanted;
    read_topics(sink, &wanted);
    if (wanted.empty()) return sink.progress(size_);
    std::uint64_t bytes = 0;
    const Statement rows(database_.get(), "SELECT rowid, topic_id, timestamp, data FROM messages WHERE rowid > " +
                                              std::to_string(last_row_) + " AND topic_id IN (" + wanted +
                                              ") ORDER BY rowid");
    step_through(rows, [&] {
      last_row_ = rows.integer(0);
      const std::string_view data = rows.bytes(3);
      bytes = std::min(size_, bytes + data.size());
      sink.unpacked(data.size());
      sink.progress(bytes);
      sink.take(
          {topics_.at(rows.integer(1)), rows.integer(2), {index, static_cast<std::uint64_t>(last_row_), 0}, data});
    });
    sink.progress(size_);
  }

  void read_at(const std::vector<BagPlace>& places, const BagSink& sink) override {
    const Statement row(database_.get(), "SELECT topic_id, timestamp, data FROM messages WHERE rowid = ?");
    if (!row.is_good()) throw failed();
    for (const BagPlace& place : places) {
      sqlite3_reset(row.get());
      sqlite3_bind_int64(row.get(), 1, static_cast<std::int64_t>(place.chunk));
      step_through(row, [&] { sink.take({topics_.at(row.integer(0)), row.integer(1), place, row.bytes(2)}); });
    }
  }

  bool goes_on() override {
    const dev_t device = device_;
    const ino_t node = node_;
    if (!find_file() || device != device_ || node != node_) return false;
    open();  // one that was opened as unchanging would not see what has come
    return true;
  }

 private:
  bool find_file() {
    struct stat status {};
    if (::stat(file_.c_str(), &status) != 0) return false;
    device_ = status.st_dev;
    node_ = status.st_ino;
    size_ = static_cast<std::uint64_t>(std::max<off_t>(status.st_size, 0));
    return true;
  }

  void open() {
    // A log of changes beside it holds what is not in the file yet; otherwise nothing is made beside it.
    std::error_code error;
    const std::uintmax_t log = fs::file_size(file_.string() + "-wal", error);
    const bool has_log = !error && log > 0;
    constexpr int kFlags = SQLITE_OPEN_READONLY | SQLITE_OPEN_URI | SQLITE_OPEN_NOMUTEX;
    sqlite3* opened = nullptr;
    const int code = sqlite3_open_v2(uri_of(file_, !has_log).c_str(), &opened, kFlags, nullptr);
    database_.reset(opened);
    if (code != SQLITE_OK) throw failed();
    sqlite3_limit(opened, SQLITE_LIMIT_LENGTH, static_cast<int>(kMaxPiece));
    sqlite3_db_config(opened, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
    sqlite3_db_config(opened, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
    require_tables();
  }

  Error failed() const {
    const int code = database_ ? sqlite3_errcode(database_.get()) : SQLITE_NOMEM;
    std::string what = file_.string() + ": SQLite: " + sqlite3_errmsg(database_.get());
    if (code == SQLITE_CORRUPT || code == SQLITE_NOTADB)
      what += "; the file is damaged or not whole: `sqlite3 " + file_.filename().string() +
              " .recover | sqlite3 saved.db3` saves what can be read";
    if (code == SQLITE_TOOBIG) what += "; at most " + megabytes(static_cast<double>(kMaxPiece)) + " a message are read";
    return Error(what);
  }

  template <typename Row>
  void step_through(const Statement& statement, const Row& take_row) const {
    if (!statement.is_good()) throw failed();
    int code = sqlite3_step(statement.get());
    for (; code == SQLITE_ROW; code = sqlite3_step(statement.get())) take_row();
    if (code != SQLITE_DONE) throw failed();
  }

  // Tables, not views: a view may compute for ever.
  void require_tables() const {
    const Statement names(database_.get(),
                          "SELECT count(*) FROM sqlite_master WHERE type = 'table' AND name IN ('topics', 'messages')");
    std::int64_t count = 0;
    step_through(names, [&] { count = names.integer(0); });
    if (count != 2)
      throw Error(file_.string() + ": is an SQLite file without the tables topics and messages: no bag of rosbag2");
  }

  void read_topics(const BagSink& sink, std::string* wanted) {
    const Statement rows(database_.get(), "SELECT id, name, type, serialization_format FROM topics");
    step_through(rows, [&] {
      const BagTopic topic{std::string(rows.bytes(1)), std::string(rows.bytes(2)), std::string(rows.bytes(3))};
      const std::size_t index = sink.topic(topic);
      topics_[rows.integer(0)] = index;
      if (sink.wants(index)) *wanted += (wanted->empty() ? "" : ",") + std::to_string(rows.integer(0));
    });
  }

  fs::path file_;
  std::uint64_t size_ = 0;
  dev_t device_ = 0;  // which file it is
  ino_t node_ = 0;
  std::int64_t last_row_ = std::numeric_limits<std::int64_t>::min();  // that has been read
  std::unique_ptr<sqlite3, decltype(&sqlite3_close)> database_{nullptr, &sqlite3_close};
  std::map<std::int64_t, std::size_t> topics_;  // of the file, to topics of the bag
};

}  // namespace

std::unique_ptr<BagFile> open_sqlite_file(const fs::path& file) { return std::make_unique<SqliteFile>(file); }

}  // namespace rigproof
