// The conformance suite of the MCAP project: cmake -DREHEARSE_MCAP_CONFORMANCE=DIR, where DIR is its folder
// tests/conformance/data. It contains each input in all forms that the format allows, NAME-FEATURES.mcap, and beside it
// the expected result of a reader, NAME-FEATURES.json. It isn't part of this repository.
//
// In a checkout without large files the .mcap are pointers that state size and SHA-256. This is sufficient: the test
// composes each file from its .json record by record, with its own code, and compares the SHA-256.
#include "file_forms.h"
#include "mcap_files.h"
#include "support/files.h"

#include <algorithm>
#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

using namespace rehearse;
using namespace rehearse::test;

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

/// A record as the suite describes it. Its numbers are texts.
struct Said {
  std::string type;
  Json fields;

  std::uint64_t number(const std::string& name) const { return std::stoull(fields.at(name).get<std::string>()); }
  std::string text(const std::string& name) const { return fields.at(name).get<std::string>(); }
  std::string data() const {
    std::string bytes;
    if (fields.at("data").is_string()) return text("data");
    for (const Json& byte : fields.at("data")) bytes += static_cast<char>(std::stoi(byte.get<std::string>()));
    return bytes;
  }
  mcap::StringMap map(const std::string& name) const { return fields.at(name).get<mcap::StringMap>(); }
};

struct Variant {
  fs::path file;  // .mcap
  std::vector<Said> records;
  std::set<std::string> features;

  bool has(const std::string& feature) const { return features.contains(feature); }
};

std::vector<Variant> all_variants() {
  std::vector<Variant> variants;
  const fs::path folder = MCAP_CONFORMANCE_DIR;
  if (folder.empty()) return variants;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.path().extension() != ".json") continue;
    const Json said = Json::parse(read_file(entry.path()));
    Variant variant;
    variant.file = fs::path(entry.path()).replace_extension(".mcap");
    for (const Json& record : said.at("records")) {
      variant.records.push_back({record.at("type").get<std::string>(), Json::object()});
      for (const Json& field : record.at("fields"))
        variant.records.back().fields[field.at(0).get<std::string>()] = field.at(1);
    }
    for (const Json& feature : said.at("meta").at("variant").at("features"))
      variant.features.insert(feature.get<std::string>());
    variants.push_back(std::move(variant));
  }
  std::ranges::stable_sort(variants, [](const Variant& a, const Variant& b) { return a.file < b.file; });
  return variants;
}

Composer& put_map(Composer& out, const mcap::StringMap& map) {
  Composer entries;
  for (const auto& [key, value] : map) entries.text(key).text(value);
  return out.put(static_cast<std::uint32_t>(entries.bytes.size())).raw(entries.bytes);
}

template <class Key>
Composer& put_counts(Composer& out, const Json& counts) {
  out.put(static_cast<std::uint32_t>(counts.size() * (sizeof(Key) + 8)));
  for (const auto& [key, value] : counts.items())
    out.put(static_cast<Key>(std::stoul(key))).put(std::uint64_t{std::stoull(value.template get<std::string>())});
  return out;
}

std::uint32_t crc32(mcap::Bytes bytes) {
  std::uint32_t crc = 0xffffffff;
  for (const std::byte byte : bytes) {
    crc ^= std::to_integer<std::uint32_t>(byte);
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1) != 0 ? 0xedb88320u : 0u);
  }
  return ~crc;
}

/// Composes a file from the description of its records, with the code of this class only.
class Composition {
 public:
  explicit Composition(const Variant& variant) : variant_(variant) {
    file_.magic();
    for (const Said& record : variant.records) put(record);
    file_.magic();
  }
  const Buffer& bytes() const { return file_.bytes; }

 private:
  /// With the extra bytes after its fields, which the feature "pad" means.
  void add(std::uint8_t opcode, Composer body) {
    if (variant_.has("pad")) body.raw(bytes_of("\x01\xff\xff"));
    file_.record(opcode, body);
  }
  void put(const Said& said);
  void put_definition(std::uint8_t opcode, const Composer& body) {
    if (variant_.has("ch") && !data_ended_) {
      chunk_.record(opcode, body);
    } else {
      add(opcode, body);
    }
  }
  void put_message(const Said& said);
  void put_chunk();
  void put_statistics(const Said& said);
  void put_index(const Said& said);

  const Variant& variant_;
  Composer file_;
  Composer chunk_;
  std::vector<std::pair<std::uint64_t, std::uint64_t>> messages_;  // of the chunk: time, offset
  std::uint64_t start_ = ~std::uint64_t{0}, end_ = 0;
  bool data_ended_ = false;
};

void Composition::put(const Said& said) {
  if (said.type == "Header") {
    add(0x01, Composer().text(said.text("profile")).text(said.text("library")));
  } else if (said.type == "Schema") {
    put_definition(0x03, Composer()
                             .put(static_cast<std::uint16_t>(said.number("id")))
                             .text(said.text("name"))
                             .text(said.text("encoding"))
                             .text(said.data()));
  } else if (said.type == "Channel") {
    Composer body;
    body.put(static_cast<std::uint16_t>(said.number("id"))).put(static_cast<std::uint16_t>(said.number("schema_id")));
    body.text(said.text("topic")).text(said.text("message_encoding"));
    put_definition(0x04, put_map(body, said.map("metadata")));
  } else if (said.type == "Message") {
    put_message(said);
  } else if (said.type == "Attachment") {
    Composer body;
    body.put(said.number("log_time")).put(said.number("create_time")).text(said.text("name"));
    body.text(said.text("media_type")).put(std::uint64_t{said.data().size()}).raw(bytes_of(said.data()));
    add(0x09, Composer(body).put(crc32(body.bytes)));
  } else if (said.type == "Metadata") {
    Composer body = Composer().text(said.text("name"));
    add(0x0c, put_map(body, said.map("metadata")));
  } else if (said.type == "DataEnd") {
    if (!chunk_.bytes.empty()) put_chunk();
    file_.record(0x0f, Composer().put(static_cast<std::uint32_t>(said.number("data_section_crc"))));
    data_ended_ = true;
  } else if (said.type == "Footer") {
    file_.record(0x02, Composer()
                           .put(said.number("summary_start"))
                           .put(said.number("summary_offset_start"))
                           .put(static_cast<std::uint32_t>(said.number("summary_crc"))));
  } else if (said.type == "Statistics") {
    put_statistics(said);
  } else {
    put_index(said);
  }
}

void Composition::put_message(const Said& said) {
  const std::uint64_t time = said.number("log_time");
  Composer body;
  body.put(static_cast<std::uint16_t>(said.number("channel_id")))
      .put(static_cast<std::uint32_t>(said.number("sequence")));
  body.put(time).put(said.number("publish_time")).raw(bytes_of(said.data()));
  if (!variant_.has("ch")) {
    file_.record(0x05, body);
    return;
  }
  messages_.emplace_back(time, chunk_.bytes.size());
  start_ = std::min(start_, time);
  end_ = std::max(end_, time);
  chunk_.record(0x05, body);
}

void Composition::put_chunk() {
  if (messages_.empty()) start_ = 0;
  file_.chunk(start_, end_, chunk_, "", {}, crc32(chunk_.bytes));
  if (!variant_.has("mx")) return;
  Composer body;
  body.put(std::uint16_t{1}).put(static_cast<std::uint32_t>(messages_.size() * 16));
  for (const auto& [time, offset] : messages_) body.put(time).put(offset);
  add(0x07, body);
}

void Composition::put_statistics(const Said& said) {
  Composer body;
  body.put(said.number("message_count")).put(static_cast<std::uint16_t>(said.number("schema_count")));
  for (const char* count : {"channel_count", "attachment_count", "metadata_count", "chunk_count"})
    body.put(static_cast<std::uint32_t>(said.number(count)));
  body.put(said.number("message_start_time")).put(said.number("message_end_time"));
  add(0x0b, put_counts<std::uint16_t>(body, said.fields.at("channel_message_counts")));
}

void Composition::put_index(const Said& said) {
  Composer body;
  if (said.type == "ChunkIndex") {
    body.put(said.number("message_start_time")).put(said.number("message_end_time"));
    body.put(said.number("chunk_start_offset")).put(said.number("chunk_length"));
    put_counts<std::uint16_t>(body, said.fields.at("message_index_offsets")).put(said.number("message_index_length"));
    body.text(said.text("compression")).put(said.number("compressed_size")).put(said.number("uncompressed_size"));
    add(0x08, body);
  } else if (said.type == "AttachmentIndex") {
    for (const char* field : {"offset", "length", "log_time", "create_time", "data_size"}) body.put(said.number(field));
    add(0x0a, body.text(said.text("name")).text(said.text("media_type")));
  } else if (said.type == "MetadataIndex") {
    add(0x0d, body.put(said.number("offset")).put(said.number("length")).text(said.text("name")));
  } else if (said.type == "SummaryOffset") {
    body.put(static_cast<std::uint8_t>(said.number("group_opcode")));
    add(0x0e, body.put(said.number("group_start")).put(said.number("group_length")));
  } else {
    ADD_FAILURE() << "a record of type " << said.type << ", which this test doesn't know";
  }
}

/// SHA-256 of each, by the system's own command.
std::vector<std::string> hashes_of(const std::vector<Buffer>& files) {
  const TempFile folder;
  fs::create_directory(folder.path());
  for (std::size_t i = 0; i < files.size(); ++i) {
    std::ofstream out(folder.path() / std::to_string(1000 + i), std::ios::binary);
    out.write(reinterpret_cast<const char*>(files[i].data()), static_cast<std::streamsize>(files[i].size()));
  }
  std::vector<std::string> hashes;
  FILE* command = ::popen(("sha256sum " + folder.path().string() + "/*").c_str(), "r");
  char line[4096];
  while (command && std::fgets(line, sizeof line, command)) hashes.push_back(std::string(line).substr(0, 64));
  if (command) ::pclose(command);
  fs::remove_all(folder.path());
  return hashes;
}

class McapConformance : public testing::Test {
 protected:
  void SetUp() override {
    if (std::string(MCAP_CONFORMANCE_DIR).empty())
      GTEST_SKIP() << "there is no conformance suite (cmake -DREHEARSE_MCAP_CONFORMANCE=DIR)";
    ASSERT_FALSE(variants().empty()) << "no .json below " << MCAP_CONFORMANCE_DIR;
  }
  static const std::vector<Variant>& variants() {
    static const std::vector<Variant> all = all_variants();
    return all;
  }
};

/// The delivered records, in the form of the suite.
struct Found {
  std::vector<mcap::StringMap> messages;
  std::vector<std::string> attachments, metadata;

  void add(const mcap::Message& message) {
    messages.push_back({{"channel_id", std::to_string(message.channel->id)},
                        {"sequence", std::to_string(message.sequence)},
                        {"log_time", std::to_string(message.log_time)},
                        {"publish_time", std::to_string(message.publish_time)},
                        {"data", text_of(message.data)}});
  }
};

mcap::StringMap expected_message(const Said& said) {
  return {{"channel_id", said.text("channel_id")},
          {"sequence", said.text("sequence")},
          {"log_time", said.text("log_time")},
          {"publish_time", said.text("publish_time")},
          {"data", said.data()}};
}

void expect_messages(const Variant& variant, std::vector<mcap::StringMap> found, bool in_order) {
  std::vector<mcap::StringMap> expected;
  for (const Said& said : variant.records)
    if (said.type == "Message") expected.push_back(expected_message(said));
  if (in_order)
    std::ranges::stable_sort(expected, [](const auto& a, const auto& b) {
      return std::stoull(a.at("log_time")) < std::stoull(b.at("log_time"));
    });
  EXPECT_EQ(found, expected);
}

void expect_definitions(const Variant& variant, const mcap::Reader& reader) {
  for (const Said& said : variant.records) {
    if (said.type == "Header") {
      EXPECT_EQ(reader.profile(), said.text("profile"));
      EXPECT_EQ(reader.library(), said.text("library"));
    } else if (said.type == "Schema") {
      const auto id = static_cast<std::uint16_t>(said.number("id"));
      EXPECT_EQ(reader.schemas().at(id), (mcap::Schema{id, said.text("name"), said.text("encoding"), said.data()}));
    } else if (said.type == "Channel") {
      const auto id = static_cast<std::uint16_t>(said.number("id"));
      EXPECT_EQ(reader.channels().at(id),
                (mcap::Channel{id, static_cast<std::uint16_t>(said.number("schema_id")), said.text("topic"),
                               said.text("message_encoding"), said.map("metadata")}));
    } else if (said.type == "Statistics") {
      const mcap::Statistics& found = reader.statistics().value();
      EXPECT_EQ(found.message_count, said.number("message_count"));
      EXPECT_EQ(found.schema_count, said.number("schema_count"));
      EXPECT_EQ(found.channel_count, said.number("channel_count"));
      EXPECT_EQ(found.attachment_count, said.number("attachment_count"));
      EXPECT_EQ(found.metadata_count, said.number("metadata_count"));
      EXPECT_EQ(found.chunk_count, said.number("chunk_count"));
      EXPECT_EQ(found.message_start_time, said.number("message_start_time"));
      EXPECT_EQ(found.message_end_time, said.number("message_end_time"));
      for (const auto& [id, count] : said.fields.at("channel_message_counts").items())
        EXPECT_EQ(std::to_string(found.channel_message_counts.at(static_cast<std::uint16_t>(std::stoul(id)))), count);
    }
  }
}

void expect_chunk(const Said& index, const mcap::Reader& reader) {
  ASSERT_EQ(reader.chunks().size(), 1u);
  const mcap::Chunk& chunk = reader.chunks()[0];
  EXPECT_EQ(chunk.offset, index.number("chunk_start_offset"));
  EXPECT_EQ(chunk.start_time, index.number("message_start_time"));
  EXPECT_EQ(chunk.end_time, index.number("message_end_time"));
  EXPECT_EQ(chunk.compression, index.text("compression"));
  EXPECT_EQ(chunk.stored_size, index.number("compressed_size"));
  EXPECT_EQ(chunk.size, index.number("uncompressed_size"));
}

void expect_attachment(const Said& said, const mcap::Attachment& found) {
  EXPECT_EQ(found.name, said.text("name"));
  EXPECT_EQ(found.media_type, said.text("media_type"));
  EXPECT_EQ(found.log_time, said.number("log_time"));
  EXPECT_EQ(found.create_time, said.number("create_time"));
  EXPECT_EQ(text_of(found.data), said.data());
}

void expect_extras(const Variant& variant, const mcap::Reader& reader) {
  for (const Said& said : variant.records) {
    if (said.type == "Attachment") expect_attachment(said, reader.attachments().at(0));
    if (said.type == "Metadata") {
      EXPECT_EQ(reader.metadata().at(0).values, said.map("metadata"));
    }
    if (said.type == "ChunkIndex") expect_chunk(said, reader);
  }
}

/// Writes the input of a variant with Rehearse's Writer, and brings the file into the form that its features name.
Buffer composed(const Variant& variant) {
  mcap::WriterOptions options;
  options.profile = options.library.emplace();
  options.compression = mcap::Compression::none;
  const Buffer whole = written(options, [&](mcap::Writer& writer) {
    for (const Said& said : variant.records) {
      if (said.type == "DataEnd") break;
      if (said.type == "Schema") {
        writer.add_schema(said.text("name"), said.text("encoding"), said.data());
      } else if (said.type == "Channel") {
        writer.add_channel(static_cast<std::uint16_t>(said.number("schema_id")), said.text("topic"),
                           said.text("message_encoding"), said.map("metadata"));
      } else if (said.type == "Message") {
        EXPECT_TRUE(writer.write(static_cast<std::uint16_t>(said.number("channel_id")), said.number("log_time"),
                                 said.number("publish_time"), bytes_of(said.data()),
                                 static_cast<std::uint32_t>(said.number("sequence"))));
      } else if (said.type == "Attachment") {
        EXPECT_TRUE(writer.add_attachment(said.text("name"), said.text("media_type"), bytes_of(said.data()),
                                          said.number("log_time"), said.number("create_time")));
      } else if (said.type == "Metadata") {
        EXPECT_TRUE(writer.add_metadata(said.text("name"), said.map("metadata")));
      }
    }
  });
  FileForm form;
  form.chunks = form.definitions_in_chunks = variant.has("ch");
  form.message_indexes = variant.has("mx");
  form.statistics = variant.has("st");
  form.repeated_schemas = variant.has("rsh");
  form.repeated_channels = variant.has("rch");
  form.attachment_indexes = variant.has("ax");
  form.metadata_indexes = variant.has("mdx");
  form.chunk_indexes = variant.has("chx");
  form.summary_offsets = variant.has("sum");
  return in_form(whole, form);
}

}  // namespace

TEST_F(McapConformance, TheFilesAreThoseOfTheSuite) {
  std::vector<Buffer> files;
  for (const Variant& variant : variants()) files.push_back(Composition(variant).bytes());
  const auto hashes = hashes_of(files);
  ASSERT_EQ(hashes.size(), files.size());
  int pointers = 0;
  for (std::size_t i = 0; i < files.size(); ++i) {
    const std::string stored = read_file(variants()[i].file);
    const bool pointer = stored.starts_with("version https://git-lfs");
    pointers += pointer;
    if (pointer) {
      EXPECT_NE(stored.find("oid sha256:" + hashes[i]), std::string::npos) << variants()[i].file;
    } else {
      EXPECT_EQ(stored, text_of(files[i])) << variants()[i].file;
    }
  }
  std::printf("%zu files, %d of them by their SHA-256 only\n", files.size(), pointers);
}

TEST_F(McapConformance, EachIsReadInEveryWay) {
  for (const Variant& variant : variants()) {
    SCOPED_TRACE(variant.file.stem().string());
    const Buffer bytes = Composition(variant).bytes();
    for (const auto opening : {mcap::Opening::walk, mcap::Opening::by_summary}) {
      const auto reader = std::move(*mcap::Reader::open_bytes(bytes, "file", {.opening = opening}));
      EXPECT_TRUE(reader->damage().empty()) << to_string(reader->damage());
      expect_definitions(variant, *reader);
      expect_extras(variant, *reader);
      Found found, in_order;
      EXPECT_TRUE(reader->for_each_message([&](const mcap::Message& message) { return found.add(message), true; }));
      EXPECT_TRUE(
          reader->for_each_message_in_order([&](const mcap::Message& message) { return in_order.add(message), true; }));
      expect_messages(variant, found.messages, false);
      expect_messages(variant, in_order.messages, true);
    }
  }
}

/// All files except those whose records have bytes after their fields.
TEST_F(McapConformance, EachIsComposedByteForByteOfAFileOfTheWriter) {
  int same = 0, padded = 0;
  for (const Variant& variant : variants()) {
    if (variant.has("pad")) {
      ++padded;
      continue;
    }
    const bool equal = composed(variant) == Composition(variant).bytes();
    EXPECT_TRUE(equal) << variant.file.stem();
    same += equal;
  }
  std::printf("%d files composed byte for byte; %d are padded\n", same, padded);
}
