// rehearse export: tables, pictures, videos.
#include <gmock/gmock.h>
#include <png.h>
#include <rehearse/io.h>

#include <array>
#include <cmath>

#include "command.h"
#include "mixed_file.h"
#include "picture/picture.h"

namespace rehearse::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

constexpr double inf = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

template <class Number>
std::vector<std::uint8_t> bytes_of_pixels(const std::vector<Number>& pixels) {
  const auto bytes = std::as_bytes(std::span(pixels));
  std::vector<std::uint8_t> data(bytes.size());
  std::memcpy(data.data(), bytes.data(), bytes.size());
  return data;
}

/// The raw samples of a PNG file, 16 bits each.
std::vector<int> samples_of(const fs::path& file) {
  std::FILE* in = std::fopen(file.c_str(), "rb");
  if (in == nullptr) return {};
  png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_init_io(png, in);
  png_read_png(png, info, PNG_TRANSFORM_IDENTITY, nullptr);
  const std::size_t bytes = png_get_bit_depth(png, info) / 8u;
  std::vector<int> samples;
  for (png_uint_32 y = 0; y < png_get_image_height(png, info); ++y) {
    const png_bytep row = png_get_rows(png, info)[y];
    for (std::size_t i = 0; i < png_get_rowbytes(png, info); i += bytes)
      samples.push_back(bytes == 2 ? row[i] << 8 | row[i + 1] : row[i]);
  }
  png_destroy_read_struct(&png, &info, nullptr);
  std::fclose(in);
  return samples;
}

class Export : public Command {
 protected:
  /// Three ticks of a robot with a joint and two cameras; an event in the second.
  Export() {
    auto writer = std::move(*mcap::Writer::create(folder() / "run.mcap"));
    TopicWriter joints(*writer, "/Robot/joints", "cdr", add_schema<msg::JointState>(*writer), {{"unit:q", "rad"}});
    TopicWriter events(*writer, "/events", "cdr", add_schema<msg::Event>(*writer));
    TopicWriter color(*writer, "/Robot/Camera/image", "cdr", add_schema<msg::CompressedImage>(*writer));
    TopicWriter depth(*writer, "/Robot/Camera/depth", "cdr", add_schema<msg::Image>(*writer));
    TopicWriter other(*writer, "/other", "protobuf");
    TopicWriter ticks(*writer, "/tick", "cdr", add_schema<msg::Tick>(*writer));
    const std::array<double, 3> knee{1.0 / 3.0, nan, -inf};
    for (std::uint64_t i = 0; i < 3; ++i) {
      const std::uint64_t time = i * 1'000'000;
      const auto stamp = msg::Time::from_ns(time);
      joints.put(time, msg::JointState{{stamp, ""}, {"KNEE"}, {knee[i]}, {}, {5e-324}});
      if (i == 1) events.put(time, msg::Event{stamp, 1, "note", "Robot", "said \"a, b\"\nand more"});
      if (i != 1) color.put(time, msg::CompressedImage{{stamp, ""}, "png", encode_png(picture(i))});
      if (i == 1) color.put(time, msg::CompressedImage{{stamp, ""}, "png", {}});  // switched off
      depth.put(
          time,
          msg::Image{
              {stamp, ""}, 1, 4, "32FC1", 0, 16, bytes_of_pixels(std::vector<float>{1.2344f, INFINITY, NAN, 100.0f})});
      msg::Tick tick{stamp, static_cast<std::int64_t>(i), ~std::uint64_t{0}, 0, 0, {}};
      if (i < 2) tick.controller_results = {true};
      ticks.put(time, tick);
    }
    other.raw(1, bytes_of("x"));
    EXPECT_TRUE(writer->close());
  }

  static Image picture(std::uint64_t number) { return {2, 1, {static_cast<std::uint8_t>(number), 20, 30, 40, 50, 60}}; }

  /// A program called ffmpeg that keeps its arguments and what it is given.
  std::string fake_ffmpeg(const std::string& end) const {
    fs::create_directory(folder() / "bin");
    write("bin/ffmpeg", "#!/bin/sh\nprintf '%s\\n' \"$@\" > arguments\ncat > pictures\n" + end + "\n");
    fs::permissions(folder() / "bin/ffmpeg", fs::perms::owner_all);
    return "PATH=" + (folder() / "bin").string() + ":$PATH";
  }
};

TEST_F(Export, WritesATableForEachTopic) {
  const Outcome outcome = done({"export", "run.mcap", "-o", "tables"});
  EXPECT_EQ(read_file(folder() / "tables/Robot_joints.csv"),
            "time [s],KNEE/q [rad],KNEE/u,header/stamp/sec,header/stamp/nanosec,header/frame_id\n"
            "0.000000000,0.3333333333333333,5e-324,0,0,\n"
            "0.001000000,NaN,5e-324,0,1000000,\n"
            "0.002000000,-Infinity,5e-324,0,2000000,\n");
  EXPECT_EQ(read_file(folder() / "tables/events.csv"),
            "time [s],stamp/sec,stamp/nanosec,tick,severity,source,text\n"
            "0.001000000,0,1000000,1,note,Robot,\"said \"\"a, b\"\"\nand more\"\n");
  EXPECT_THAT(read_file(folder() / "tables/tick.csv"),
              HasSubstr("0.001000000,1,18446744073709551615,0,0,1,0,1000000\n"));
  EXPECT_THAT(outcome.out, HasSubstr("tables/Robot_joints.csv: 3 rows, 6 columns\n"));
  EXPECT_THAT(outcome.out, HasSubstr("left out of /Robot/Camera/image and 1 more topic: data\n"));
  EXPECT_THAT(outcome.out, HasSubstr("left out /other: messages of encoding 'protobuf' without a schema"));
}

TEST_F(Export, LeavesNoPartOfATableOnAFullDisk) {
  sr1_without_cameras();
  done({"record", "sr1.yaml", "-o", "long.mcap"});
  fs::create_directory(folder() / "tables");
  write("tables/tick.csv", "time [s],of an earlier export\n");
  // at most 2 KiB per file, like a full disk; the signal is ignored, so that writing returns an error
  const Outcome full =
      run("/bin/sh", {"-c", "trap '' XFSZ; ulimit -f 4; " + quoted(command.string()) + " export long.mcap -o tables"});
  EXPECT_EQ(full.status, 2) << full.out;
  EXPECT_THAT(full.err, HasSubstr("can't write"));
  std::vector<std::string> left;
  for (const auto& entry : fs::directory_iterator(folder() / "tables")) left.push_back(entry.path().filename());
  EXPECT_THAT(left, ElementsAre("tick.csv"));
  EXPECT_EQ(read_file(folder() / "tables/tick.csv"), "time [s],of an earlier export\n");
}

TEST_F(Export, WritesFieldsWithoutSeriesToo) {
  auto writer = *mcap::Writer::create(folder() / "imu.mcap");
  const std::uint16_t schema = writer->add_schema(msg::Imu::type_name, "ros2msg", msg::schema_text<msg::Imu>());
  const std::uint16_t channel = writer->add_channel(schema, "/R/A/imu", "cdr");
  msg::Imu imu;
  imu.header.frame_id = "base";
  imu.orientation.x = 0.25;
  imu.orientation_covariance[8] = 3.5;
  CdrWriter cdr;
  msg::encode(imu, cdr);
  ASSERT_TRUE(writer->write(channel, 0, 0, cdr.bytes()));
  ASSERT_TRUE(writer->close());
  done({"export", "imu.mcap", "-o", "tables"});
  const std::string text = read_file(folder() / "tables/R_A_imu.csv");
  EXPECT_THAT(text, HasSubstr(",header/stamp/sec,header/stamp/nanosec,header/frame_id,orientation/x,"));
  EXPECT_THAT(text, HasSubstr(",orientation_covariance/8,"));
  EXPECT_THAT(text, HasSubstr(",0,0,base,0.25,0,0,1,"));
  EXPECT_THAT(text, HasSubstr(",3.5,"));
}

TEST_F(Export, NamesTheFieldsThatItLeavesOut) {
  const Outcome outcome = done({"export", "run.mcap", "-o", "all.csv", "--joined"});
  EXPECT_THAT(outcome.out,
              HasSubstr("left out of /Robot/joints: header/frame_id, header/stamp/nanosec, header/stamp/sec"));
  const nlohmann::json left_out =
      done({"export", "run.mcap", "-o", "all.csv", "--joined", "--json"}).json()["left_out"];
  EXPECT_EQ(left_out[0]["topic"], "/Robot/joints");
}

TEST_F(Export, JoinsAllSeriesByTick) {
  done({"export", "run.mcap", "-o", "all.csv", "--joined", "--ticks", "1.."});
  const std::string text = read_file(folder() / "all.csv");
  EXPECT_EQ(text,
            "time [s],Robot/KNEE/q [rad],Robot/KNEE/u,tick,state_hash,input_hash,output_hash,controller_results/0\n"
            "0.001000000,NaN,5e-324,1,18446744073709551615,0,0,1\n"
            "0.002000000,-Infinity,5e-324,2,18446744073709551615,0,0,0\n");
}

TEST_F(Export, JoinsSelectedTopicsByTheTicksOfTheRecording) {
  done({"export", "run.mcap", "-o", "all.csv", "--joined", "--topics", "/Robot/joints", "--ticks", "1.."});
  EXPECT_EQ(read_file(folder() / "all.csv"),
            "time [s],Robot/KNEE/q [rad],Robot/KNEE/u\n"
            "0.001000000,NaN,5e-324\n"
            "0.002000000,-Infinity,5e-324\n");
}

TEST_F(Export, JoinsNothingOfALogWithoutTicks) {
  auto writer = std::move(*mcap::Writer::create(folder() / "log.mcap"));
  TopicWriter(*writer, "/fast", "cdr", add_schema<msg::JointState>(*writer)).put(0, msg::JointState());
  ASSERT_TRUE(writer->close());
  const Outcome outcome = rehearse({"export", "log.mcap", "-o", "all.csv", "--joined"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("no selected message is a tick"));
  EXPECT_FALSE(exists("all.csv"));
}

/// A row for each message of the clock, two at one time included, with the last values of the other topic.
TEST_F(Export, JoinsAnyLogByTheMessagesOfATopic) {
  auto writer = std::move(*mcap::Writer::create(folder() / "log.mcap"));
  TopicWriter fast(*writer, "/fast", "cdr", add_schema<msg::JointState>(*writer));
  TopicWriter slow(*writer, "/slow", "cdr", add_schema<msg::JointState>(*writer));
  const auto joint = [](const char* name, double q) {
    msg::JointState state;
    state.name = {name};
    state.position = {q};
    return state;
  };
  fast.put(0, joint("A", 0.0));
  slow.put(5, joint("B", 7.0));
  fast.put(10, joint("A", 1.0));
  fast.put(20, joint("A", 2.0));
  fast.put(20, joint("A", 3.0));
  slow.put(20, joint("B", 8.0));
  slow.put(25, joint("B", 9.0));
  ASSERT_TRUE(writer->close());
  done({"export", "log.mcap", "-o", "log.csv", "--joined", "--clock", "/fast"});
  EXPECT_EQ(read_file(folder() / "log.csv"),
            "time [s],A/q,B/q\n"
            "0.000000000,0,\n"
            "0.000000010,1,7\n"
            "0.000000020,2,7\n"
            "0.000000020,3,8\n");
  EXPECT_EQ(rehearse({"export", "log.mcap", "-o", "x.csv", "--joined", "--clock", "/imu"}).status, 2);
  EXPECT_EQ(rehearse({"export", "log.mcap", "-o", "x", "--clock", "/fast"}).status, 2);
}

TEST_F(Export, WritesThePicturesThatWereRecorded) {
  const Outcome outcome = done({"export", "run.mcap", "-o", "pictures", "--frames", "--json"});
  EXPECT_EQ(read_file(folder() / "pictures/Robot_Camera_image.csv"),
            "time [s],captured [s],file\n"
            "0.000000000,0.000000000,Robot_Camera_image/000000.png\n"
            "0.001000000,0.001000000,\n"
            "0.002000000,0.002000000,Robot_Camera_image/000002.png\n");
  const std::string bytes = read_file(folder() / "pictures/Robot_Camera_image/000002.png");
  EXPECT_EQ(decode_png({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()})->pixels, picture(2).pixels);
  EXPECT_THAT(samples_of(folder() / "pictures/Robot_Camera_depth/000000.png"), ElementsAre(1234, 0, 0, 65535));
  const auto written = outcome.json().at("written");
  EXPECT_EQ(written[0].at("topic"), "/Robot/Camera/image");
  EXPECT_EQ(written[0].at("pictures"), 2);
  EXPECT_EQ(written[1].at("pictures"), 3);
}

TEST_F(Export, KeepsTheValuesOfEveryEncoding) {
  struct Case {
    std::string encoding;
    std::uint8_t is_bigendian;
    std::uint32_t width;
    std::vector<std::uint8_t> data;
    std::vector<int> samples;
  };
  const std::vector<Case> cases{
      {"rgb8", 0, 1, {1, 2, 3}, {1, 2, 3}},        {"bgr8", 0, 1, {1, 2, 3}, {3, 2, 1}},
      {"rgba8", 0, 1, {1, 2, 3, 4}, {1, 2, 3, 4}}, {"bgra8", 0, 1, {1, 2, 3, 4}, {3, 2, 1, 4}},
      {"mono8", 0, 2, {1, 255}, {1, 255}},         {"mono16", 0, 1, {1, 2}, {0x0201}},
      {"16UC1", 1, 1, {1, 2}, {0x0102}},           {"32FC1", 1, 1, {0x3f, 0x80, 0, 0}, {1000}}};
  {
    auto writer = std::move(*mcap::Writer::create(folder() / "kinds.mcap"));
    for (const Case& c : cases) {
      TopicWriter topic(*writer, "/" + c.encoding, "cdr", add_schema<msg::Image>(*writer));
      std::vector<std::uint8_t> data = c.data;
      const auto step = static_cast<std::uint32_t>(data.size() + 3);  // rows may be padded
      data.resize(step + c.data.size());
      std::ranges::copy(c.data, data.begin() + step);
      topic.put(0, msg::Image{{}, 2, c.width, c.encoding, c.is_bigendian, step, data});
    }
    TopicWriter topic(*writer, "/yuv", "cdr", add_schema<msg::Image>(*writer));
    topic.put(0, msg::Image{{}, 1, 2, "yuv422", 0, 4, {1, 2, 3, 4}});
    topic.put(1, msg::Image{{}, 1000, 1000, "rgb8", 0, 3000, {1, 2, 3, 4}});
    ASSERT_TRUE(writer->close());
  }
  const Outcome outcome = rehearse({"export", "kinds.mcap", "-o", "out", "--frames"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("topic /yuv: pictures of encoding 'yuv422' can't be written"));
  EXPECT_THAT(outcome.err,
              HasSubstr("a picture states 1000 x 1000 pixels of rgb8 in rows of 3000 bytes, but has 4 bytes"));
  for (const Case& c : cases) {
    std::vector<int> twice = c.samples;
    twice.insert(twice.end(), c.samples.begin(), c.samples.end());
    EXPECT_EQ(samples_of(folder() / "out" / c.encoding / "000000.png"), twice) << c.encoding;
  }
}

TEST_F(Export, MakesNoFolderWithTheNameOfATable) {
  const Outcome outcome = rehearse({"export", "run.mcap", "-o", "all.csv"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_EQ(outcome.err,
            "error: -o all.csv is the name of one table, and each topic has its own (one table of all: --joined; a "
            "table for each topic: name a folder)\n");
  EXPECT_FALSE(exists("all.csv"));
}

TEST_F(Export, ReplacesItsOwnKindOnly) {
  fs::create_directory(folder() / "tables");
  write("tables/events.csv", "mine,not yours\n");
  const Outcome refused = rehearse({"export", "run.mcap", "-o", "tables"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, HasSubstr("won't replace tables/events.csv: it exists and is no table of Rehearse"));
  EXPECT_FALSE(exists("tables/Robot_joints.csv")) << "nothing is written then";
  fs::remove(folder() / "tables/events.csv");
  done({"export", "run.mcap", "-o", "tables"});
  done({"export", "run.mcap", "-o", "tables"});
  write("file", "x");
  EXPECT_THAT(rehearse({"export", "run.mcap", "-o", "file"}).err, HasSubstr("can't make the folder file"));
  EXPECT_THAT(rehearse({"export", "run.mcap", "-o", "file", "--joined"}).err, HasSubstr("won't replace file"));
  EXPECT_EQ(read_file(folder() / "file"), "x");
}

TEST_F(Export, NamesTopicsThatAreAlikeApart) {
  auto writer = std::move(*mcap::Writer::create(folder() / "names.mcap"));
  for (const char* topic : {"/a/b", "/a_b", "/../x y", ""}) {
    TopicWriter(*writer, topic, "cdr", add_schema<msg::Event>(*writer)).put(0, msg::Event{});
  }
  ASSERT_TRUE(writer->close());
  done({"export", "names.mcap", "-o", "t"});
  for (const char* name : {"t/a_b.csv", "t/a_b_2.csv", "t/%2E._x%20y.csv", "t/_.csv"})
    EXPECT_TRUE(exists(name)) << name;
}

TEST_F(Export, HandsThePicturesToFfmpeg) {
  const std::string environment = fake_ffmpeg("printf 'xxxxftypisom' > walk.mp4");
  const Outcome outcome =
      rehearse({"export", "run.mcap", "-o", "walk.mp4", "--video", "--topics", "*image"}, environment);
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("walk.mp4: 2 pictures"));
  const std::string arguments = read_file(folder() / "arguments");
  EXPECT_THAT(arguments, HasSubstr("-framerate\n500.000000\n-c:v\npng\n-i\npipe:0\n"));
  EXPECT_THAT(arguments, HasSubstr("yuv420p\nfile:" + (folder() / "walk.mp4").string() + "\n"));
  const auto first = encode_png(picture(0)), last = encode_png(picture(2));
  EXPECT_EQ(read_file(folder() / "pictures"),
            std::string(first.begin(), first.end()) + std::string(last.begin(), last.end()));
}

TEST_F(Export, SaysWhyThereIsNoVideo) {
  const auto refusal = [&](std::vector<std::string> arguments, const std::string& environment) {
    arguments.insert(arguments.begin(), {"export", "run.mcap", "--video", "-o"});
    const Outcome outcome = rehearse(arguments, environment);
    EXPECT_EQ(outcome.status, 2);
    return outcome.err;
  };
  const std::string failing = fake_ffmpeg("printf half > half.mp4; exit 3");
  EXPECT_THAT(
      refusal({"a.mp4"}, failing),
      HasSubstr("a video is of one topic with pictures; /Robot/Camera/image, /Robot/Camera/depth are selected"));
  EXPECT_THAT(refusal({"a.avi", "--topics", "*image"}, failing), HasSubstr("'.avi' is no kind of video"));
  EXPECT_THAT(refusal({"half.mp4", "--topics", "*image"}, failing), HasSubstr("ffmpeg could not make the video"));
  EXPECT_FALSE(exists("half.mp4"));
  EXPECT_THAT(refusal({"a.gif", "--topics", "*image"}, "PATH=/nowhere"), HasSubstr("apt-get install ffmpeg"));
  write("mine.mp4", "my own text, long enough");
  EXPECT_THAT(refusal({"mine.mp4", "--topics", "*image"}, failing), HasSubstr("won't replace mine.mp4"));
}

TEST_F(Export, WritesWhatIsWholeOfADamagedFile) {
  const std::string bytes = read_file(folder() / "run.mcap");
  write("cut.mcap", bytes.substr(0, bytes.size() - 20));
  const Outcome outcome = rehearse({"export", "cut.mcap", "-o", "tables"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_TRUE(exists("tables/Robot_joints.csv"));
  EXPECT_THAT(outcome.err, HasSubstr("cut.mcap: error: "));
}

}  // namespace
}  // namespace rehearse::test
