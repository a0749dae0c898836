#include "answer_store.h"

#include <algorithm>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/core/folders.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char* kFormat = "rigproof-sweep-pack 2";
constexpr const char* kFormatBefore = "rigproof-sweep-pack 1";  // reasons in words
constexpr std::size_t kTasksOfPack = 100;
constexpr std::size_t kNameDigits = 16;

// Gives equal values the same number, in the order in which they come.
class Numbered {
 public:
  std::size_t number_of(const json& value) {
    const auto found = std::find(values_.begin(), values_.end(), value);
    if (found != values_.end()) return static_cast<std::size_t>(found - values_.begin());
    values_.push_back(value);
    return values_.size() - 1;
  }
  const json& values() const { return values_; }

 private:
  json values_ = json::array();
};

AnswerBrief brief_of(const SweepAnswer& answer) {
  const SweepRow& rig = answer.rows.front();
  return {rig.status, rig.reasons, answer.machine};
}

json json_of(const AnswerBrief& brief) {
  return {static_cast<int>(brief.status), reasons_json(brief.reasons), json_of(brief.machine)};
}

AnswerBrief brief_of(const json& list) {
  return {sweep_status_of(list.at(0).get<int>()), reasons_of(list.at(1)), machine_of(list.at(2))};
}

AnswerBrief brief_of_before(const json& list) {
  return {sweep_status_of(list.at(0).get<int>()), reasons_of_before(list.at(1), list.at(2)), machine_of(list.at(3))};
}

// Its content decides, so that a changed plan never overwrites a pack of other tasks.
fs::path pack_file(const SweepFolder& folder, const std::vector<WorkItem>& order, const PackRange& range) {
  std::string keys;
  for (std::size_t i = range.first; i < range.last; ++i) keys += order[i].task->key;
  return folder.packs() / (sha256_hex(keys).substr(0, kNameDigits) + ".jsonl");
}

// The first line says what follows, so that nobody has to read the rest to know how far the sweep is.
std::string pack_text(const json& answers, const json& briefs, const SweepPlan& plan, const std::string& body) {
  json methods = json::array();
  for (std::size_t i = 0; i < plan.hashes.size(); ++i) methods.push_back({plan.table.methods[i], plan.hashes[i]});
  const json header = {{"format", kFormat}, {"methods", methods}, {"briefs", briefs}, {"answers", answers}};
  return header.dump(-1, ' ', false, json::error_handler_t::replace) + "\n" + body;
}

void remove_singles(const SweepFolder& folder, const SweepPlan& plan, const std::vector<WorkItem>& order,
                    const PackRange& range) {
  std::error_code ignored;
  for (std::size_t i = range.first; i < range.last; ++i) {
    const std::string& task = order[i].task->key;
    for (const std::string& method : plan.table.methods) fs::remove(folder.answer_file(task, method), ignored);
    fs::remove(folder.tasks() / task, ignored);  // unless something else is in it
  }
}

}  // namespace

std::vector<WorkItem> work_order(const std::vector<SweepTask>& tasks) {
  std::unordered_map<std::string, std::size_t> by_key, sets;
  std::vector<WorkItem> order;
  for (const SweepTask& task : tasks) {
    const auto [place, is_new] = by_key.emplace(task.key, order.size());
    if (is_new)
      order.push_back({&task, 1});
    else
      ++order[place->second].repeats;
    sets.emplace(task.pictures, sets.size());
  }
  std::stable_sort(order.begin(), order.end(), [&sets](const WorkItem& a, const WorkItem& b) {
    return sets.at(a.task->pictures) < sets.at(b.task->pictures);
  });
  return order;
}

PackRange pack_of(std::size_t place, const std::vector<WorkItem>& order) {
  const std::size_t first = place / kTasksOfPack * kTasksOfPack;
  return {first, std::min(first + kTasksOfPack, order.size())};
}

// Single files first: one that is packed meanwhile is then in a pack.
AnswerStore::AnswerStore(SweepFolder folder, const SweepPlan& plan)
    : folder_(std::move(folder)), plan_(plan), places_(plan.table.methods.size()) {
  for (const fs::directory_entry& entry : folder_entries(folder_.tasks()))
    singles_.insert(entry.path().filename().string());
  std::vector<std::pair<fs::file_time_type, fs::path>> files;
  std::error_code ignored;
  for (const fs::directory_entry& entry : folder_entries(folder_.packs()))
    if (entry.path().extension() == ".jsonl") files.emplace_back(entry.last_write_time(ignored), entry.path());
  std::sort(files.begin(), files.end());  // the newest pack of a task counts
  for (const auto& [time, file] : files) list_pack(file);
}

// A damaged pack is none: its tasks are done again.
void AnswerStore::list_pack(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::string line;
  if (!std::getline(in, line)) return;
  std::error_code error;
  const std::uintmax_t size = fs::file_size(file, error);
  try {
    const json header = json::parse(line);
    const bool is_before = header.at("format") == kFormatBefore;
    if (!is_before && header.at("format") != kFormat) return;
    std::uint64_t offset = line.size() + 1;
    std::vector<std::optional<std::size_t>> methods;  // of the plan, by the pack's own number
    for (const json& entry : header.at("methods")) {
      const std::vector<std::string>& names = plan_.table.methods;
      const auto place = static_cast<std::size_t>(std::find(names.begin(), names.end(), entry.at(0)) - names.begin());
      const bool is_planned = place < names.size() && plan_.hashes[place] == entry.at(1).get<std::string>();
      methods.push_back(is_planned ? std::optional<std::size_t>(place) : std::nullopt);
    }
    const std::size_t first_brief = briefs_.size();
    for (const json& entry : header.at("briefs"))
      briefs_.push_back(is_before ? brief_of_before(entry) : brief_of(entry));
    std::vector<std::pair<std::size_t, std::pair<std::string, Place>>> found;
    for (const json& entry : header.at("answers")) {
      const Place place{packs_.size(), offset, entry.at(2).get<std::uint64_t>(),
                        first_brief + entry.at(3).get<std::size_t>()};
      offset += place.bytes;
      const std::optional<std::size_t>& method = methods.at(entry.at(1).get<std::size_t>());
      if (place.brief >= briefs_.size() || place.bytes > size) return;
      if (method) found.push_back({*method, {entry.at(0).get<std::string>(), place}});
    }
    if (error || offset != size) return;
    packs_.push_back(file);
    for (auto& [method, entry] : found) places_[method][entry.first] = entry.second;
  } catch (const std::exception&) {
    return;
  }
}

std::optional<SweepAnswer> AnswerStore::load_single(const std::string& task, std::size_t method) const {
  return has_single(task) ? load_answer(folder_, plan_, task, method) : std::nullopt;
}

std::optional<SweepAnswer> AnswerStore::load_packed(const std::string& task, std::size_t method) const {
  const auto found = places_[method].find(task);
  if (found == places_[method].end()) return std::nullopt;
  const Place& place = found->second;
  std::ifstream in(packs_[place.pack], std::ios::binary);
  std::string text(place.bytes, '\0');
  if (!in.seekg(static_cast<std::streamoff>(place.offset)) ||
      !in.read(text.data(), static_cast<std::streamsize>(text.size())))
    return std::nullopt;
  std::optional<SweepAnswer> answer = read_answer(text);
  return answer && answer->method_hash == plan_.hashes[method] ? answer : std::nullopt;
}

std::optional<SweepAnswer> AnswerStore::load(const std::string& task, std::size_t method) const {
  std::optional<SweepAnswer> single = load_single(task, method);
  return single ? single : load_packed(task, method);
}

std::optional<AnswerBrief> AnswerStore::brief(const std::string& task, std::size_t method) const {
  if (const std::optional<SweepAnswer> single = load_single(task, method)) return brief_of(*single);
  const auto found = places_[method].find(task);
  if (found == places_[method].end()) return std::nullopt;
  return briefs_[found->second.brief];
}

void AnswerStore::pack_if_complete(const std::vector<WorkItem>& order, const PackRange& range) const {
  Numbered briefs;
  json answers = json::array();
  std::string body;
  bool has_new = false;
  for (std::size_t i = range.first; i < range.last; ++i) {
    const std::string& task = order[i].task->key;
    for (std::size_t method = 0; method < plan_.table.methods.size(); ++method) {
      std::optional<SweepAnswer> answer = load_answer(folder_, plan_, task, method);
      has_new = has_new || answer;
      if (!answer) answer = load_packed(task, method);
      if (!answer) return;  // another process is at it, or has packed it
      const std::string text = text_of(*answer);
      answers.push_back({task, method, text.size(), briefs.number_of(json_of(brief_of(*answer)))});
      body += text;
    }
  }
  if (!has_new) return;
  write_file_atomically(pack_file(folder_, order, range), pack_text(answers, briefs.values(), plan_, body));
  remove_singles(folder_, plan_, order, range);
}

}  // namespace rigproof
