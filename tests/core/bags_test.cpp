// Bags that others write, whole, unfinished, damaged and hostile. The bytes come from tests/support/bag_bytes.cpp,
// which shares no code with the reader.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "bag_bytes.h"
#include "error_text.h"
#include "rigproof/bags/bag.h"
#include "rigproof/bags/bag_writer.h"
#include "rigproof/bags/messages.h"
#include "temp_folder.h"

namespace rigproof {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

// Forty poses on two topics, so that small chunks are several.
std::vector<Recorded> some_messages(bool big_endian = false) {
  std::vector<Recorded> messages;
  for (int i = 0; i < 40; ++i) {
    const double t = 100.0 + 0.5 * i;
    messages.push_back(
        {"/odom", kOdometryType, t, odometry_message(t, {0.1 * i, 0, 0, 0, 0, 0, 1}, "base", big_endian)});
    messages.push_back({"/chatter", "std_msgs/msg/String", t, CdrBytes(big_endian).text("hello").str()});
  }
  return messages;
}

struct ReadBag {
  std::vector<double> x_m;
  std::vector<BagPlace> places;
  std::vector<std::string> notes;
  std::size_t topics = 0;
};

bool wants_odometry(const BagTopic& topic) { return topic.name == "/odom"; }

ReadBag read_all(const std::filesystem::path& path, const std::filesystem::path& scratch) {
  Bag bag(path, scratch);
  ReadBag result;
  bag.read(wants_odometry, [&](const BagMessage& message) {
    result.x_m.push_back(read_odometry_message(message.data).T_odom_child.translation.x());
    result.places.push_back(message.place);
  });
  result.notes = bag.notes();
  result.topics = bag.topics().size();
  // Every message again, from where it lies.
  std::size_t again = 0;
  bag.read_at(result.places, [&](const BagMessage& message) {
    EXPECT_EQ(read_odometry_message(message.data).T_odom_child.translation.x(), result.x_m.at(again++));
  });
  EXPECT_EQ(again, result.x_m.size());
  return result;
}

void expect_whole(const ReadBag& bag) {
  ASSERT_EQ(bag.x_m.size(), 40U);
  for (int i = 0; i < 40; ++i) EXPECT_EQ(bag.x_m[static_cast<std::size_t>(i)], 0.1 * i);
  EXPECT_EQ(bag.topics, 2U);
}

TEST(Bags, McapOfEveryCompressionAndByteOrderIsRead) {
  const TempFolder scratch;
  for (const bool big_endian : {false, true}) {
    for (const char* compression : {"", "lz4", "zstd"}) {
      McapLayout layout;
      layout.compression = compression;
      const auto file = scratch.write("bag.mcap", mcap_bytes(some_messages(big_endian), layout));
      const ReadBag bag = read_all(file, scratch / "scratch");
      expect_whole(bag);
      EXPECT_THAT(bag.notes, IsEmpty());
    }
    McapLayout plain;
    plain.chunks = plain.checksums = false;
    expect_whole(
        read_all(scratch.write("bag.mcap", mcap_bytes(some_messages(big_endian), plain)), scratch / "scratch"));
  }
}

TEST(Bags, SqliteOfEverySchemaIsRead) {
  const TempFolder scratch;
  for (const int schema : {1, 3, 4}) {
    const auto file = scratch / ("bag " + std::to_string(schema) + "%.db3");
    write_sqlite_bag(file, some_messages(schema == 3), schema);
    expect_whole(read_all(file, scratch / "scratch"));
  }
}

TEST(Bags, CompressedFilesAndMessagesAreRead) {
  const TempFolder scratch;
  std::vector<Recorded> packed = some_messages();
  for (Recorded& message : packed) message.data = zstd_packed(message.data);
  expect_whole(read_all(scratch.write("messages.mcap", mcap_bytes(packed)), scratch / "scratch"));
  write_sqlite_bag(scratch / "messages.db3", packed);
  expect_whole(read_all(scratch / "messages.db3", scratch / "scratch"));
  write_sqlite_bag(scratch / "plain.db3", some_messages());
  expect_whole(read_all(scratch.write("bag.db3.zstd", zstd_packed(scratch.read("plain.db3"))), scratch / "scratch"));
  expect_whole(read_all(scratch.write("bag.mcap.zstd", zstd_packed(mcap_bytes(some_messages()))), scratch / "scratch"));
}

TEST(Bags, FilesOfAFolderAreReadInTheOrderOfItsMetadata) {
  const TempFolder scratch;
  const std::vector<Recorded> all = some_messages();
  const std::vector<Recorded> first(all.begin(), all.begin() + 30), second(all.begin() + 30, all.end());
  scratch.write("bag/bag_10.mcap", mcap_bytes(second));
  scratch.write("bag/bag_9.mcap", mcap_bytes(first));
  EXPECT_TRUE(is_bag(scratch / "bag"));
  const ReadBag guessed = read_all(scratch / "bag", scratch / "scratch");
  expect_whole(guessed);
  EXPECT_THAT(guessed.notes, testing::ElementsAre(HasSubstr("no metadata.yaml")));
  // Early versions wrote the folder's name before the files'.
  scratch.write("bag/metadata.yaml", metadata_yaml({"bag_9.mcap", "bag/bag_10.mcap"}));
  expect_whole(read_all(scratch / "bag", scratch / "scratch"));
  const ReadBag one = read_all(scratch / "bag/bag_9.mcap", scratch / "scratch");
  EXPECT_EQ(one.x_m.size(), 15U);
  EXPECT_THAT(one.notes, testing::ElementsAre(HasSubstr("give the folder")));
}

TEST(Bags, MissingFilesOfMetadataAreAllNamed) {
  const TempFolder scratch;
  scratch.write("bag/bag_1.mcap", mcap_bytes(some_messages()));
  scratch.write("bag/metadata.yaml", metadata_yaml({"bag_0.mcap", "bag_1.mcap", "bag_2.mcap"}));
  const std::string text = error_text([&] { read_all(scratch / "bag", scratch / "scratch"); });
  EXPECT_THAT(text, HasSubstr("bag_0.mcap"));
  EXPECT_THAT(text, HasSubstr("bag_2.mcap"));
  EXPECT_THAT(text, HasSubstr("metadata.yaml:5"));
  scratch.write("bag/metadata.yaml", metadata_yaml({"../../etc/passwd"}));
  EXPECT_THAT(error_text([&] { read_all(scratch / "bag", scratch / "scratch"); }), HasSubstr("passwd"));
  scratch.write("bag/metadata.yaml", "rosbag2_bagfile_information: {version: 5}\n");
  EXPECT_THAT(error_text([&] { read_all(scratch / "bag", scratch / "scratch"); }), HasSubstr("ros2 bag reindex"));
}

TEST(Bags, UnfinishedMcapIsReadAsFarAsItGoes) {
  const TempFolder scratch;
  McapLayout layout;
  layout.finished = false;
  layout.compression = "zstd";
  const std::string bytes = mcap_bytes(some_messages(), layout);
  const ReadBag whole = read_all(scratch.write("bag.mcap", bytes), scratch / "scratch");
  expect_whole(whole);
  EXPECT_THAT(whole.notes, testing::ElementsAre(HasSubstr("never finished")));
  // Cut anywhere: what is before is read, and nothing else happens.
  for (const std::size_t size : {std::size_t{12}, bytes.size() / 3, bytes.size() / 2, bytes.size() - 5}) {
    const ReadBag cut = read_all(scratch.write("bag.mcap", bytes.substr(0, size)), scratch / "scratch");
    EXPECT_LT(cut.x_m.size(), 41U);
    EXPECT_THAT(cut.notes, testing::ElementsAre(HasSubstr("as far as it goes")));
  }
  const ReadBag zeros = read_all(scratch.write("bag.mcap", bytes + std::string(5000, '\0')), scratch / "scratch");
  expect_whole(zeros);
}

// In place, as a recorder does.
void overwrite(const std::filesystem::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary) << bytes;
}

// Reads on, and holds that each message comes once, in its order.
void read_on(Bag* bag, ReadBag* so_far) {
  bag->read(wants_odometry, [&](const BagMessage& message) {
    so_far->x_m.push_back(read_odometry_message(message.data).T_odom_child.translation.x());
    so_far->places.push_back(message.place);
  });
  so_far->topics = bag->topics().size();
  std::size_t again = 0;
  bag->read_at(so_far->places, [&](const BagMessage& message) {
    EXPECT_EQ(read_odometry_message(message.data).T_odom_child.translation.x(), so_far->x_m.at(again++));
  });
  EXPECT_EQ(again, so_far->x_m.size()) << "what was read before can be read again";
}

TEST(Bags, OfAnMcapThatGrowsOnlyWhatHasComeIsRead) {
  const TempFolder scratch;
  for (const char* compression : {"", "lz4", "zstd"}) {
    McapLayout layout;
    layout.compression = compression;
    layout.chunk_bytes = 1024;
    const std::string bytes = mcap_bytes(some_messages(), layout);
    const auto file = scratch.write("bag.mcap", bytes.substr(0, 100));
    Bag bag(file, scratch / "scratch");
    ReadBag so_far;
    read_on(&bag, &so_far);
    std::size_t before = 0, came = 0;
    for (std::size_t size = 100; size < bytes.size(); size += bytes.size() / 7) {
      overwrite(file, bytes.substr(0, size));
      ASSERT_TRUE(bag.goes_on());
      read_on(&bag, &so_far);
      EXPECT_THAT(bag.notes(), testing::ElementsAre(HasSubstr("as far as it goes")));
      came += so_far.x_m.size() > before;
      before = so_far.x_m.size();
    }
    EXPECT_GT(came, 2U);
    overwrite(file, bytes);
    ASSERT_TRUE(bag.goes_on());
    read_on(&bag, &so_far);
    expect_whole(so_far);
    EXPECT_THAT(bag.notes(), IsEmpty());
    const std::uint64_t unpacked = bag.unpacked_bytes();
    ASSERT_TRUE(bag.goes_on());
    read_on(&bag, &so_far);
    expect_whole(so_far);
    EXPECT_EQ(bag.unpacked_bytes(), unpacked) << "nothing is unpacked twice";
  }
}

TEST(Bags, OfSqliteThatGrowsOnlyWhatHasComeIsRead) {
  const TempFolder scratch;
  const std::vector<Recorded> messages = some_messages();
  write_sqlite_bag(scratch / "first.db3", {messages.begin(), messages.begin() + 30});
  write_sqlite_bag(scratch / "whole.db3", messages);
  const auto file = scratch.write("bag.db3", scratch.read("first.db3"));
  Bag bag(file, scratch / "scratch");
  ReadBag so_far;
  read_on(&bag, &so_far);
  EXPECT_EQ(so_far.x_m.size(), 15U);
  const std::uint64_t unpacked = bag.unpacked_bytes();
  overwrite(file, scratch.read("whole.db3"));
  ASSERT_TRUE(bag.goes_on());
  read_on(&bag, &so_far);
  expect_whole(so_far);
  EXPECT_LT(bag.unpacked_bytes() - unpacked, 2 * unpacked);
}

TEST(Bags, FurtherFilesOfABagThatGrowsAreRead) {
  const TempFolder scratch;
  const std::vector<Recorded> messages = some_messages();
  scratch.write("bag/bag_0.mcap", mcap_bytes({messages.begin(), messages.begin() + 30}));
  Bag bag(scratch / "bag", scratch / "scratch");
  ReadBag so_far;
  read_on(&bag, &so_far);
  scratch.write("bag/bag_1.mcap", mcap_bytes({messages.begin() + 30, messages.end()}));
  ASSERT_TRUE(bag.goes_on());
  read_on(&bag, &so_far);
  expect_whole(so_far);
}

TEST(Bags, WhatWasReplacedOrCutDoesNotGoOn) {
  const TempFolder scratch;
  const std::string bytes = mcap_bytes(some_messages());
  const auto file = scratch.write("bag.mcap", bytes);
  Bag replaced(file, scratch / "scratch");
  // Another file in its place, while the first is still held.
  scratch.write("new.mcap", bytes);
  std::filesystem::rename(scratch / "new.mcap", file);
  EXPECT_FALSE(replaced.goes_on());
  Bag cut(file, scratch / "scratch");
  overwrite(file, bytes.substr(0, bytes.size() / 2));
  EXPECT_FALSE(cut.goes_on());
  const auto packed = scratch.write("bag.mcap.zstd", zstd_packed(bytes));
  EXPECT_FALSE(Bag(packed, scratch / "scratch").goes_on());
}

TEST(Bags, AnyFlippedByteOfAChunkIsFound) {
  const TempFolder scratch;
  for (const char* compression : {"", "lz4", "zstd"}) {
    McapLayout layout;
    layout.compression = compression;
    std::string bytes = mcap_bytes(some_messages(), layout);
    bytes[bytes.size() / 2] ^= 0x10;
    const auto file = scratch.write("bag.mcap", bytes);
    EXPECT_THAT(error_text([&] { read_all(file, scratch / "scratch"); }), HasSubstr("mcap recover")) << compression;
  }
  // Without chunks the checksum of all data tells.
  McapLayout plain;
  plain.chunks = false;
  std::string bytes = mcap_bytes(some_messages(), plain);
  bytes[bytes.find("hello") + 1] = 'u';
  EXPECT_THAT(error_text([&] { read_all(scratch.write("bag.mcap", bytes), scratch / "scratch"); }),
              HasSubstr("CRC-32"));
}

TEST(Bags, HostileLengthsTakeNoMemory) {
  const TempFolder scratch;
  const std::string magic("\x89MCAP0\r\n", 8);
  const auto failure = [&](const std::string& records) {
    const auto file = scratch.write("bag.mcap", magic + records + magic);
    return error_text([&] { read_all(file, scratch / "scratch"); });
  };
  const std::uint64_t huge = std::uint64_t{1} << 60U;
  EXPECT_THAT(failure(mcap_chunk("x", "zstd", huge, 0)), HasSubstr("at most"));
  EXPECT_THAT(failure(mcap_chunk("x", "none of ours", 10, 0)), HasSubstr("is not known"));
  EXPECT_THAT(failure(mcap_chunk("x", "", 10, 0)), HasSubstr("claims 10"));
  EXPECT_THAT(failure(mcap_chunk(zstd_packed(std::string(1000, 'a')), "zstd", 10, 0)), HasSubstr("zstd"));
  std::string record = mcap_record(5, "x");
  std::memcpy(record.data() + 1, &huge, sizeof huge);
  EXPECT_THAT(failure(record), HasSubstr("are there"));
  // A record that reaches beyond its chunk, a message of no channel, a footer too early, a chunk in a chunk.
  EXPECT_THAT(failure(mcap_chunk(record, "", record.size(), 0)), HasSubstr("beyond its chunk"));
  EXPECT_THAT(failure(mcap_record(5, std::string(30, 'x'))), HasSubstr("never described"));
  EXPECT_THAT(failure(mcap_record(5, "x")), HasSubstr("ends early"));
  EXPECT_THAT(failure(mcap_record(2, std::string(20, '\0'))), HasSubstr("footer"));
  // A message that unpacks to gigabytes.
  std::string bomb = zstd_packed(std::string(300U << 20U, 'a'));
  const auto file = scratch.write("bomb.mcap", mcap_bytes({{"/odom", kOdometryType, 1.0, bomb}}));
  EXPECT_THAT(error_text([&] { read_all(file, scratch / "scratch"); }), HasSubstr("unpacks to more than"));
}

TEST(Bags, WhatIsNoBagIsRefusedWithWhatToDo) {
  const TempFolder scratch;
  const auto failure = [&](const std::filesystem::path& path) {
    return error_text([&] { read_all(path, scratch / "scratch"); });
  };
  EXPECT_THAT(failure(scratch.write("one.bag", "#ROSBAG V2.0\n...")), HasSubstr("rosbags-convert --src one.bag"));
  McapLayout ros1;
  ros1.profile = "ros1";
  EXPECT_THAT(failure(scratch.write("one.mcap", mcap_bytes(some_messages(), ros1))), HasSubstr("rosbags-convert"));
  EXPECT_THAT(failure(scratch.write("empty.mcap", "")), HasSubstr("is empty"));
  EXPECT_THAT(failure(scratch.write("text.mcap", "hello, this is a text")), HasSubstr("is no bag"));
  EXPECT_THAT(failure(scratch / "none.mcap"), HasSubstr("no such file"));
  std::filesystem::create_directories(scratch / "folder");
  EXPECT_THAT(failure(scratch / "folder"), HasSubstr("holds no bag"));
  EXPECT_FALSE(is_bag(scratch / "folder"));
}

TEST(Bags, DamagedSqliteSaysHowToSaveIt) {
  const TempFolder scratch;
  write_sqlite_bag(scratch / "bag.db3", some_messages());
  const std::string bytes = scratch.read("bag.db3");
  const auto failure = [&](const std::string& content) {
    const auto file = scratch.write("damaged.db3", content);
    return error_text([&] { read_all(file, scratch / "scratch"); });
  };
  EXPECT_THAT(failure(bytes.substr(0, 9000)), HasSubstr(".recover"));
  std::string torn = bytes;
  torn.replace(5000, 4000, 4000, '\x7f');
  EXPECT_THAT(failure(torn), HasSubstr(".recover"));
  EXPECT_THAT(failure(bytes.substr(0, 100)), HasSubstr("SQLite"));
}

TEST(Bags, ReadingIsInterruptedWhereTheCallerSays) {
  const TempFolder scratch;
  Bag bag(scratch.write("bag.mcap", mcap_bytes(some_messages())), scratch / "scratch");
  bag.progress = [](std::uint64_t, std::uint64_t) { return false; };
  try {
    bag.read(wants_odometry, [](const BagMessage&) {});
    FAIL() << "nothing was thrown";
  } catch (const Error& error) {
    EXPECT_EQ(error.exit_code(), ExitCode::kTryAgain);
  }
}

// ------------------------------------------------------------------------------------------------------- written bags

void write_poses(const std::filesystem::path& file, BagPacking packing, int count) {
  BagWriter bag(file, packing);
  for (int i = 0; i < count; ++i) {
    RosOdometry odometry;
    odometry.header = {1000 + i, "odom"};
    odometry.T_odom_child.translation.x() = 0.1 * i;
    bag.write("/odom", kOdometryType, odometry.header.stamp_ns, message_bytes(odometry));
    const std::string pixels(200000, 'x');  // so that there are several chunks
    RosCompressedImage image{{1000 + i, "eye"}, "png", pixels};
    bag.write("/eye", kCompressedImageType, image.header.stamp_ns, message_bytes(image));
  }
  bag.finish();
}

TEST(BagWriter, WhatItWritesIsReadWhateverThePacking) {
  const TempFolder scratch;
  for (const BagPacking packing : {BagPacking::kNone, BagPacking::kLz4, BagPacking::kZstd}) {
    const std::filesystem::path file = scratch / ("bag" + std::to_string(static_cast<int>(packing)) + ".mcap");
    write_poses(file, packing, 40);
    const ReadBag bag = read_all(file, scratch / "scratch");
    expect_whole(bag);
    EXPECT_THAT(bag.notes, IsEmpty());
    EXPECT_NE(bag.places.front().chunk, bag.places.back().chunk);
  }
}

TEST(BagWriter, AFileAppearsWholeOrNotAtAll) {
  const TempFolder scratch;
  const std::filesystem::path file = scratch / "bag.mcap";
  { const BagWriter interrupted(file, BagPacking::kZstd); }
  EXPECT_TRUE(std::filesystem::is_empty(scratch.path()));
  write_poses(file, BagPacking::kZstd, 1);
  EXPECT_THAT(error_text([&] { BagWriter(file, BagPacking::kZstd); }), HasSubstr("there is something already"));
  EXPECT_THAT(error_text([&] { BagWriter(scratch / "bag.mcap/a.mcap", BagPacking::kZstd); }),
              HasSubstr("bag.mcap: cannot create the folder"));
}

// Written by one and read by the other half, and the bytes are those of the tests' own writer.
TEST(BagMessages, AreWrittenAsOthersWriteThem) {
  RosCameraInfo info;
  info.header = {1700000000250000000, "eye"};
  info.width = 640;
  info.height = 360;
  info.distortion_model = "plumb_bob";
  info.d = {0.1, -0.2, 0.001, 0.002, 0};
  info.k = {320, 0, 319.5, 0, 321, 179.5, 0, 0, 1};
  info.r = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  info.roi.x_offset = 3;
  InfoFields fields;
  fields.frame_id = "eye";
  fields.width = 640;
  fields.height = 360;
  fields.d = info.d;
  fields.k = {info.k.begin(), info.k.end()};
  fields.x_offset = 3;
  EXPECT_EQ(message_bytes(info), info_message(fields, 1700000000.25));
  EXPECT_EQ(message_bytes(RosCompressedImage{info.header, "png", "abcde"}),
            compressed_message(1700000000.25, "eye", "png", "abcde"));
  RosImage image;
  image.header = info.header;
  image.height = 1;
  image.width = image.step = 3;
  image.encoding = "mono8";
  image.data = "abc";
  ImageFields pixels{1700000000.25, "eye", 3, 1, 3, "mono8", false, "abc"};
  EXPECT_EQ(message_bytes(image), image_message(pixels));
  RosOdometry odometry{{0, "odom"}, "base_link", Rigid3({0.5, 0.5, 0.5, 0.5}, {1, 2, 3}), ""};
  EXPECT_EQ(message_bytes(odometry), odometry_message(0.0, {1, 2, 3, 0.5, 0.5, 0.5, 0.5}));
  odometry.velocity.x() = 0.3;
  odometry.angular_velocity.z() = -0.2;
  const RosOdometry again = read_odometry_message(message_bytes(odometry));
  EXPECT_EQ(again.velocity.x(), 0.3);
  EXPECT_EQ(again.angular_velocity.z(), -0.2);
  const std::vector<RosTransform> transforms = {{{0, "a"}, "b", odometry.T_odom_child, ""}};
  EXPECT_EQ(message_bytes(transforms), tf_message(0.0, {{"a", "b", {1, 2, 3, 0.5, 0.5, 0.5, 0.5}}}));
}

TEST(BagMessages, DefinitionsBringThoseOfAllTheirParts) {
  const std::string text = message_definition(kOdometryType);
  for (const char* part :
       {"std_msgs/Header", "builtin_interfaces/Time", "geometry_msgs/Quaternion", "geometry_msgs/Vector3"})
    EXPECT_THAT(text, HasSubstr(std::string("MSG: ") + part + "\n"));
  EXPECT_THAT(error_text([] { message_definition("std_msgs/msg/String"); }), HasSubstr("std_msgs/msg/String"));
}

TEST(BagMessages, AreReadInBothByteOrders) {
  for (const bool big_endian : {false, true}) {
    ImageFields fields;
    fields.stamp_s = 1700000000.25;
    fields.width = 3;
    fields.height = 2;
    fields.step = 9;
    fields.encoding = "rgb8";
    fields.data = "abcdefghijklmnopqr";
    const std::string image_bytes = image_message(fields, big_endian);
    const RosImage image = read_image(image_bytes);
    EXPECT_EQ(image.header.stamp_ns, 1700000000250000000);
    EXPECT_EQ(image.header.frame_id, "camera_optical");
    EXPECT_EQ(image.width, 3U);
    EXPECT_EQ(image.step, 9U);
    EXPECT_EQ(image.data, fields.data);

    InfoFields info_fields;
    info_fields.width = 640;
    info_fields.height = 480;
    info_fields.d = {0.1, -0.2, 0.001, 0.002, 0.3};
    info_fields.k = {600, 0, 320, 0, 601, 240, 0, 0, 1};
    info_fields.binning_x = 2;
    info_fields.roi_width = 320;
    const RosCameraInfo info = read_camera_info_message(info_message(info_fields, 1.0, big_endian));
    EXPECT_EQ(info.d, info_fields.d);
    EXPECT_EQ(info.k[4], 601.0);
    EXPECT_EQ(info.binning_x, 2U);
    EXPECT_EQ(info.roi.width, 320U);
    EXPECT_EQ(info.distortion_model, "plumb_bob");

    const auto transforms = read_tf_message(tf_message(
        2.5, {{"base_link", "a", {1, 2, 3, 0, 0, 0, 1}}, {"a", "optical", {0, 0, 0.5, -0.5, 0.5, -0.5, 0.5}}},
        big_endian));
    ASSERT_EQ(transforms.size(), 2U);
    EXPECT_EQ(transforms[0].T_parent_child.translation, Eigen::Vector3d(1, 2, 3));
    EXPECT_EQ(transforms[1].header.frame_id, "a");
    EXPECT_EQ(transforms[1].T_parent_child.rotation.x(), -0.5);
  }
}

TEST(BagMessages, TruncatedAndHostileOnesAreErrors) {
  const std::string whole = tf_message(1.0, {{"a", "b", {}}, {"b", "c", {}}});
  for (std::size_t size = 0; size < whole.size(); ++size)
    EXPECT_NE(error_text([&] { read_tf_message(std::string_view(whole).substr(0, size)); }), "") << size;
  // A length of 2^32 - 1 in a message of a few bytes.
  EXPECT_THAT(error_text([] { read_tf_message(CdrBytes().number(std::uint32_t{0xFFFFFFFF}).str()); }),
              HasSubstr("a list of"));
  EXPECT_THAT(error_text([] { read_header(CdrBytes().number(1).number(2).number(std::uint32_t{0xFFFFFFFF}).str()); }),
              HasSubstr("a list of"));
  EXPECT_THAT(error_text([] { read_header("PL_CDR"); }), HasSubstr("no plain CDR"));
}

TEST(BagMessages, WhatIsNoPoseIsToldBesideTheGoodOnes) {
  EXPECT_THAT(read_odometry_message(odometry_message(1.0, {0, 0, 0, 0, 0, 0, 0})).no_pose, HasSubstr("norm 0"));
  const auto transforms =
      read_tf_message(tf_message(1.0, {{"a", "b", {NAN, 0, 0, 0, 0, 0, 1}}, {"b", "c", {1, 2, 3, 0, 0, 0, 1}}}));
  ASSERT_EQ(transforms.size(), 2U);
  EXPECT_THAT(transforms[0].no_pose, HasSubstr("finite numbers"));
  EXPECT_EQ(transforms[1].no_pose, "");
  EXPECT_EQ(transforms[1].T_parent_child.translation, Eigen::Vector3d(1, 2, 3));
}

}  // namespace
}  // namespace rigproof
