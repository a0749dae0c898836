// A memory of findings that lasts as long as its test, and counts.
#pragma once

#include <map>
#include <mutex>
#include <optional>
#include <string>

#include "rigproof/calib/vision/picture_memory.h"

namespace rigproof {

/// Files stand for their content.
class MapMemory : public PictureMemory {
 public:
  std::string content_of(const std::string& file) const override { return known ? "content of " + file : ""; }
  std::optional<std::string> recall(Finding finding, const std::string& key) override {
    const std::lock_guard<std::mutex> guard(mutex_);
    const auto found = kept_.find(key);
    if (found == kept_.end()) return std::nullopt;
    ++recalled[finding];
    return found->second;
  }
  void keep(Finding finding, const std::string& key, const std::string& bytes) override {
    const std::lock_guard<std::mutex> guard(mutex_);
    ++kept[finding];
    kept_[key] = bytes;
  }
  void damage() {
    for (auto& [key, bytes] : kept_) bytes.resize(bytes.size() / 2);
  }

  bool known = true;
  std::map<Finding, int> recalled, kept;

 private:
  std::mutex mutex_;
  std::map<std::string, std::string> kept_;
};

}  // namespace rigproof
