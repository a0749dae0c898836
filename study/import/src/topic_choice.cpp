#include "topic_choice.h"

#include <algorithm>
#include <map>
#include <set>

#include "rigproof/core/error.h"
#include "rigproof/core/rig_yaml.h"
#include "rigproof/core/text.h"
#include "topic_names.h"

namespace rigproof {
namespace {

bool contains(const std::string& text, const char* word) { return text.find(word) != std::string::npos; }

std::string listed(const std::vector<std::string>& names) {
  return names.empty() ? "none" : for_message(joined(names), 400);
}

template <typename Topic>
std::vector<std::string> names_of(const std::vector<Topic>& topics) {
  std::vector<std::string> names;
  for (const Topic& topic : topics) names.push_back(topic.name);
  return names;
}

// ------------------------------------------------------------------------------------------------------- odometry

int odometry_rank(const std::string& name) {
  static const char* const kFromSenses[] = {"visual", "vio",  "icp",     "gps",   "truth",
                                            "amcl",   "t265", "rtabmap", "lidar", "rgbd"};
  int rank = 0;
  if (parts_of(name).back() == "odom") rank += 3;
  if (contains(name, "wheel") || contains(name, "diff") || contains(name, "base_controller")) rank += 2;
  if (contains(name, "filtered")) rank += 1;
  for (const char* word : kFromSenses) rank -= contains(name, word) ? 5 : 0;
  return rank;
}

const PoseTopic* find_pose(const BagSurvey& survey, const std::string& name) {
  for (const std::vector<PoseTopic>* topics : {&survey.odometry, &survey.tf})
    for (const PoseTopic& topic : *topics)
      if (topic.name == name || topic.name.rfind(name + " ", 0) == 0) return &topic;
  return nullptr;
}

const PoseTopic* best_odometry(const std::vector<PoseTopic>& topics, Problems* problems) {
  std::vector<const PoseTopic*> best;
  for (const PoseTopic& topic : topics) {
    if (!best.empty() && odometry_rank(topic.name) < odometry_rank(best.front()->name)) continue;
    if (!best.empty() && odometry_rank(topic.name) > odometry_rank(best.front()->name)) best.clear();
    best.push_back(&topic);
  }
  if (best.size() == 1) return best.front();
  if (best.size() > 1)
    problems->add({"", 0, "odometry", listed(names_of(topics)),
                   "several could be it; say which: --topic odometry=" + best.front()->name});
  return nullptr;
}

const PoseTopic* choose_odometry(const BagSurvey& survey, const std::vector<TopicRule>& rules, Problems* problems) {
  for (const TopicRule& rule : rules) {
    if (rule.name != "odometry") continue;
    const PoseTopic* topic = find_pose(survey, rule.topic);
    std::vector<std::string> known = names_of(survey.odometry), others = names_of(survey.tf);
    known.insert(known.end(), others.begin(), others.end());
    if (topic == nullptr)
      problems->add({"", 0, "--topic odometry", for_message(rule.topic),
                     "the bag has no odometry (nav_msgs/Odometry, /tf) there; " + suggestion(rule.topic, known)});
    return topic;
  }
  if (!survey.odometry.empty()) return best_odometry(survey.odometry, problems);
  if (!survey.tf.empty()) return best_odometry(survey.tf, problems);
  problems->add(
      {"", 0, "odometry", "",
       "the bag has neither nav_msgs/Odometry nor a transform odom -> base_link in /tf; record the topic of the "
       "wheels' odometry, too"});
  return nullptr;
}

// Empty where there is no other, or a rule says which.
std::string note_of_other_odometry(const BagSurvey& survey, const PoseTopic& chosen,
                                   const std::vector<TopicRule>& rules) {
  const bool is_given =
      std::any_of(rules.begin(), rules.end(), [](const TopicRule& rule) { return rule.name == "odometry"; });
  std::vector<std::string> ways;
  for (const PoseTopic& topic : survey.odometry)
    if (!is_given && topic.name != chosen.name) ways.push_back("--topic odometry=" + topic.name);
  if (ways.empty()) return "";
  return "odometry is " + chosen.name +
         "; others that are not taken, and what takes them: " + for_message(joined(ways), 400);
}

// -------------------------------------------------------------------------------------------------------- cameras

// Of the images of one camera: what is complete and unchanged first.
int image_rank(const ImageTopic& topic) {
  int rank = 0;
  if (!topic.is_compressed()) rank += 4;
  if (topic.encoding == "png") rank += 2;
  if (!is_rectified(topic.name)) rank += 1;
  if (contains(topic.name, "mono")) rank -= 1;
  return rank;
}

// Another transport of it, or raw, rectified and coloured pictures side by side. Frames tell, names where headers have
// none.
bool same_camera(const ImageTopic& a, const ImageTopic& b) {
  if (without_transport(a.name) == without_transport(b.name)) return true;
  if (namespace_of(a.name) != namespace_of(b.name)) return false;
  if (!a.frame_id().empty() && !b.frame_id().empty()) return a.frame_id() == b.frame_id();
  return place_in(a.name) == place_in(b.name);
}

std::vector<const ImageTopic*> guessed_images(const BagSurvey& survey, bool side_products) {
  std::vector<const ImageTopic*> best;
  for (const ImageTopic& topic : survey.images) {
    if (topic.is_depth || is_side_product(topic.name) != side_products) continue;
    const auto there = std::find_if(best.begin(), best.end(),
                                    [&topic](const ImageTopic* other) { return same_camera(*other, topic); });
    if (there == best.end())
      best.push_back(&topic);
    else if (image_rank(topic) > image_rank(**there))
      *there = &topic;
  }
  std::sort(best.begin(), best.end());  // as they lie in the survey
  return best;
}

std::vector<CameraTopics> guessed_cameras(const BagSurvey& survey) {
  std::vector<const ImageTopic*> images = guessed_images(survey, false);
  if (images.empty()) images = guessed_images(survey, true);
  std::vector<std::string> topics;
  for (const ImageTopic* image : images) topics.push_back(image->name);
  const std::vector<std::string> names = camera_names(topics);
  std::vector<CameraTopics> cameras;
  for (std::size_t i = 0; i < topics.size(); ++i) cameras.push_back({names[i], topics[i], "", "", false, false});
  return cameras;
}

const ImageTopic* require_image(const BagSurvey& survey, const TopicRule& rule, bool depth, Problems* problems) {
  const ImageTopic* topic = survey.find_image(rule.topic);
  if (topic == nullptr || topic->is_depth != depth) {
    std::vector<std::string> known;
    for (const ImageTopic& image : survey.images)
      if (image.is_depth == depth) known.push_back(image.name);
    problems->add(
        {"", 0, "--topic " + rule.name + (depth ? ".depth" : ""), for_message(rule.topic),
         std::string("the bag has no ") + (depth ? "depth " : "") + "images there; " + suggestion(rule.topic, known)});
    return nullptr;
  }
  return topic;
}

// The camera that was guessed of the topic, or else of another one of the same camera; what other rules gave stays.
std::vector<CameraTopics>::iterator find_guessed(const BagSurvey& survey, const ImageTopic& topic,
                                                 std::vector<CameraTopics>* cameras) {
  const auto exact = std::find_if(cameras->begin(), cameras->end(), [&topic](const CameraTopics& camera) {
    return !camera.is_given && camera.images == topic.name;
  });
  if (exact != cameras->end()) return exact;
  return std::find_if(cameras->begin(), cameras->end(), [&](const CameraTopics& camera) {
    return !camera.is_given && same_camera(*survey.find_image(camera.images), topic);
  });
}

/// @param left_out gets what a rule says not to take
void apply_image_rule(const BagSurvey& survey, const TopicRule& rule, std::vector<CameraTopics>* cameras,
                      std::vector<const ImageTopic*>* left_out, Problems* problems) {
  const auto named = std::find_if(cameras->begin(), cameras->end(),
                                  [&](const CameraTopics& camera) { return camera.name == rule.name; });
  if (rule.topic == "none") {
    if (named == cameras->end()) return;
    left_out->push_back(survey.find_image(named->images));
    cameras->erase(named);
    return;
  }
  const ImageTopic* topic = require_image(survey, rule, false, problems);
  if (topic == nullptr) return;
  // It may have been guessed under another name.
  const auto guessed = find_guessed(survey, *topic, cameras);
  if (named != cameras->end()) {
    named->images = rule.topic;
    named->is_given = true;
    if (guessed != cameras->end() && guessed != named && guessed->images == rule.topic) cameras->erase(guessed);
  } else if (guessed != cameras->end()) {
    guessed->name = rule.name;
    guessed->images = rule.topic;
    guessed->is_given = true;
  } else {
    cameras->push_back({rule.name, rule.topic, "", "", false, true});
  }
}

// The rule that takes images: in place of another topic of the same camera, or as one more camera.
std::string rule_that_takes(const BagSurvey& survey, const ImageTopic& topic,
                            const std::vector<CameraTopics>& cameras) {
  std::vector<std::string> topics;
  for (const CameraTopics& camera : cameras) {
    if (same_camera(*survey.find_image(camera.images), topic))
      return "--topic " + camera.name + "=" + topic.name + " in place of " + camera.images;
    topics.push_back(camera.images);
  }
  topics.push_back(topic.name);
  std::string name = camera_names(topics).back();
  const std::vector<std::string> taken = names_of(cameras);
  while (std::find(taken.begin(), taken.end(), name) != taken.end()) name += "_2";
  return "--topic " + name + "=" + topic.name;
}

// Empty where all images are taken. Nobody misses other transports, what a rule chose another picture of, and what was
// to be left out.
std::string note_of_untaken(const BagSurvey& survey, const std::vector<CameraTopics>& cameras,
                            const std::vector<const ImageTopic*>& left_out) {
  std::vector<std::string> rules;
  for (const ImageTopic& topic : survey.images) {
    const auto has_it = [&](const CameraTopics& camera) {
      return without_transport(camera.images) == without_transport(topic.name) ||
             (camera.is_given && place_in(camera.images) == place_in(topic.name) &&
              same_camera(*survey.find_image(camera.images), topic));
    };
    const auto same = [&topic](const ImageTopic* other) { return same_camera(*other, topic); };
    if (topic.is_depth || std::any_of(cameras.begin(), cameras.end(), has_it) ||
        std::any_of(left_out.begin(), left_out.end(), same))
      continue;
    rules.push_back(rule_that_takes(survey, topic, cameras));
  }
  return rules.empty() ? "" : "images that are not taken, and what takes them: " + for_message(joined(rules), 800);
}

void check_doubles(const std::vector<TopicRule>& rules, Problems* problems) {
  std::map<std::string, std::string> first;
  for (const TopicRule& rule : rules) {
    if (rule.topic == "none" || rule.part == "camera_info") continue;
    const std::string key = "--topic " + rule.name + (rule.part.empty() ? "" : "." + rule.part);
    const auto [place, is_new] = first.emplace(rule.topic, key);
    if (!is_new)
      problems->add({"", 0, key, for_message(rule.topic),
                     "is given to " + place->second + " already; every camera needs a topic of its own"});
  }
}

// ---------------------------------------------------------------------------------------------------------- depth

// How well a depth topic goes with a camera; 0: not at all.
int depth_rank(const ImageTopic& depth, const ImageTopic& image) {
  const bool same_frame = depth.frame_id() == image.frame_id();
  const std::size_t shared = shared_parts(depth.name, image.name);
  if (!same_frame && shared == 0) return 0;
  int rank = same_frame ? 100 : 1;
  if (depth.width == image.width && depth.height == image.height) rank += 20;
  if (contains(depth.name, "aligned") || contains(depth.name, "registered") || contains(depth.name, "to_rgb") ||
      contains(depth.name, "to_color"))
    rank += 10;
  if (!depth.is_compressed()) rank += 1;
  rank += static_cast<int>(2 * shared);
  constexpr int kAnyImage = 1000;  // images before clouds
  return depth.is_cloud() ? rank : rank + kAnyImage;
}

void guess_depth(const BagSurvey& survey, std::vector<CameraTopics>* cameras) {
  std::set<std::string> taken;
  for (const CameraTopics& camera : *cameras) taken.insert(camera.depth);
  // The best pair first, so that a camera does not take what is another's.
  for (;;) {
    int best_rank = 0;
    CameraTopics* best = nullptr;
    const ImageTopic* best_depth = nullptr;
    for (CameraTopics& camera : *cameras) {
      if (camera.depth_is_given || !camera.depth.empty()) continue;
      for (const ImageTopic& depth : survey.images) {
        if (!depth.is_depth || taken.count(depth.name) > 0) continue;
        const int rank = depth_rank(depth, *survey.find_image(camera.images));
        if (rank > best_rank) {
          best_rank = rank;
          best = &camera;
          best_depth = &depth;
        }
      }
    }
    if (best == nullptr) return;
    best->depth = best_depth->name;
    // Other transports of the same depth are nobody's.
    for (const ImageTopic& depth : survey.images)
      if (without_transport(depth.name) == without_transport(best_depth->name)) taken.insert(depth.name);
  }
}

// ---------------------------------------------------------------------------------------------------- camera info

// Of the CameraInfo beside the images what names the same place, or the one for all. If it could be another camera's,
// too, frames have to tell.
std::string info_topic_of(const BagSurvey& survey, const CameraTopics& camera) {
  const ImageTopic& of = *survey.find_image(camera.images);
  const std::string beside = namespace_of(of.name), place = place_in(of.name);
  const InfoTopic* info = place.empty() ? survey.find_info(beside + "/camera_info") : nullptr;
  const auto is_named = [&](const InfoTopic& some) {
    return namespace_of(some.name) == beside && place_in(some.name) == place;
  };
  if (info == nullptr && std::count_if(survey.infos.begin(), survey.infos.end(), is_named) == 1)
    info = &*std::find_if(survey.infos.begin(), survey.infos.end(), is_named);
  const bool for_all = info == nullptr;
  if (for_all) info = survey.find_info(beside + "/camera_info");
  if (info == nullptr) return "";
  const auto in_frame = [&](const ImageTopic& image) { return image.frame_id() == info->info.header.frame_id; };
  // Also of a camera that was left out: it may still be that one's.
  const bool is_shared = std::any_of(survey.images.begin(), survey.images.end(), [&](const ImageTopic& other) {
    return !other.is_depth && !is_side_product(other.name) && !same_camera(other, of) &&
           namespace_of(other.name) == beside && (for_all || place_in(other.name) == place) &&
           (in_frame(other) || !in_frame(of));
  });
  return is_shared ? "" : info->name;
}

void apply_part_rule(const BagSurvey& survey, const TopicRule& rule, std::vector<CameraTopics>* cameras,
                     Problems* problems) {
  const auto named = std::find_if(cameras->begin(), cameras->end(),
                                  [&](const CameraTopics& camera) { return camera.name == rule.name; });
  if (named == cameras->end()) {
    problems->add({"", 0, "--topic " + rule.name + "." + rule.part, for_message(rule.topic),
                   "there is no camera of this name; " + suggestion(rule.name, names_of(*cameras))});
    return;
  }
  if (rule.part == "depth") {
    named->depth_is_given = true;
    if (rule.topic != "none" && require_image(survey, rule, true, problems) != nullptr) named->depth = rule.topic;
    return;
  }
  if (survey.find_info(rule.topic) == nullptr)
    problems->add({"", 0, "--topic " + rule.name + ".camera_info", for_message(rule.topic),
                   "the bag has no CameraInfo there; " + suggestion(rule.topic, names_of(survey.infos))});
  named->camera_info = rule.topic;
}

std::string what_is_there(const BagSurvey& survey) {
  std::string notes;
  for (const std::string& note : survey.notes) notes += "; " + note;
  if (survey.topics.empty()) return "it has no messages at all" + notes;
  std::vector<std::string> topics;
  for (const BagTopic& topic : survey.topics)
    topics.push_back(topic.name + " (" + (topic.type.empty() ? "unknown type" : topic.type) +
                     (topic.encoding == "cdr" ? "" : ", encoding " + topic.encoding) + ")");
  return "it has " + for_message(joined(topics), 600) + notes;
}

}  // namespace

std::vector<TopicRule> topic_rules(const std::vector<std::string>& texts) {
  std::vector<TopicRule> rules;
  Problems problems;
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    TopicRule rule;
    rule.name = text.substr(0, equals);
    for (const char* part : {"depth", "camera_info"}) {
      const std::string end = std::string(".") + part;
      if (rule.name.size() <= end.size() || rule.name.compare(rule.name.size() - end.size(), end.size(), end) != 0)
        continue;
      rule.part = part;
      rule.name.erase(rule.name.size() - end.size());
    }
    rule.topic = equals == std::string::npos ? "" : text.substr(equals + 1);
    if (!is_frame_name(rule.name) || rule.topic.empty())
      problems.add(
          {"", 0, "--topic", for_message(text),
           "must be NAME=TOPIC, NAME.depth=TOPIC, NAME.camera_info=TOPIC or odometry=TOPIC, with none for no topic"});
    if (rule.topic != "none" && rule.topic.rfind('/', 0) != 0) rule.topic = "/" + rule.topic;
    rules.push_back(std::move(rule));
  }
  problems.throw_if_any();
  return rules;
}

TopicChoice choose_topics(const BagSurvey& survey, const std::vector<TopicRule>& rules) {
  TopicChoice choice;
  Problems problems;
  choice.odometry = choose_odometry(survey, rules, &problems);
  choice.cameras = guessed_cameras(survey);
  check_doubles(rules, &problems);
  std::vector<const ImageTopic*> left_out;
  for (const TopicRule& rule : rules)
    if (rule.name != "odometry" && rule.part.empty())
      apply_image_rule(survey, rule, &choice.cameras, &left_out, &problems);
  for (const TopicRule& rule : rules)
    if (rule.name != "odometry" && !rule.part.empty()) apply_part_rule(survey, rule, &choice.cameras, &problems);
  if (choice.cameras.empty() && problems.all().size() < 2)
    problems.add(
        {"", 0, "cameras", "", "the bag has no images (sensor_msgs/Image, CompressedImage); " + what_is_there(survey)});
  problems.throw_if_any();
  guess_depth(survey, &choice.cameras);
  for (CameraTopics& camera : choice.cameras)
    if (camera.camera_info.empty()) camera.camera_info = info_topic_of(survey, camera);
  if (const std::string note = note_of_other_odometry(survey, *choice.odometry, rules); !note.empty())
    choice.notes.push_back(note);
  if (const std::string note = note_of_untaken(survey, choice.cameras, left_out); !note.empty())
    choice.notes.push_back(note);
  return choice;
}

}  // namespace rigproof
