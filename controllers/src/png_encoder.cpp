#include "png_encoder.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace cnoid {

namespace {

void appendBigEndian(std::string& bytes, std::uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift & 0xff);
}

std::array<std::uint32_t, 256> makeCrcTable() {
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t n = 0; n < table.size(); ++n) {
    std::uint32_t c = n;
    for (int bit = 0; bit < 8; ++bit) c = c & 1 ? 0xedb88320u ^ c >> 1 : c >> 1;
    table[n] = c;
  }
  return table;
}

std::uint32_t crc32(const std::string& bytes) {
  static const std::array<std::uint32_t, 256> table = makeCrcTable();
  std::uint32_t crc = 0xffffffffu;
  for (const char byte : bytes) crc = table[(crc ^ static_cast<unsigned char>(byte)) & 0xff] ^ crc >> 8;
  return ~crc;
}

std::uint32_t adler32(const std::string& bytes) {
  std::uint32_t a = 1;
  std::uint32_t b = 0;
  for (const char byte : bytes) {
    a = (a + static_cast<unsigned char>(byte)) % 65521;
    b = (b + a) % 65521;
  }
  return b << 16 | a;
}

/// A zlib stream of stored blocks, each of at most 65535 bytes behind its length and the length's complement.
std::string zlibStored(const std::string& data) {
  std::string stream = "\x78\x01";
  std::size_t place = 0;
  do {
    const std::size_t length = std::min<std::size_t>(data.size() - place, 65535);
    stream += place + length == data.size() ? '\x01' : '\x00';
    for (const std::size_t field : {length, ~length}) {
      stream += static_cast<char>(field & 0xff);
      stream += static_cast<char>(field >> 8 & 0xff);
    }
    stream.append(data, place, length);
    place += length;
  } while (place < data.size());
  appendBigEndian(stream, adler32(data));
  return stream;
}

void appendChunk(std::string& png, const std::string& type, const std::string& data) {
  appendBigEndian(png, static_cast<std::uint32_t>(data.size()));
  png += type + data;
  appendBigEndian(png, crc32(type + data));
}

}  // namespace

std::string encodePng(int width, int height, int components, const std::vector<unsigned char>& pixels) {
  constexpr std::array<char, 5> colorTypes = {0, 0, 4, 2, 6};  // by number of components
  std::string header;
  appendBigEndian(header, static_cast<std::uint32_t>(width));
  appendBigEndian(header, static_cast<std::uint32_t>(height));
  header += '\x08';  // bits per component
  header += colorTypes.at(static_cast<std::size_t>(components));
  header.append(3, '\0');  // deflate, the standard filters, no interlacing

  std::string rows;
  const auto rowSize = static_cast<std::size_t>(width) * static_cast<std::size_t>(components);
  for (std::size_t row = 0; row < static_cast<std::size_t>(height); ++row) {
    rows += '\0';  // no filter
    rows.append(reinterpret_cast<const char*>(pixels.data()) + row * rowSize, rowSize);
  }

  std::string png = "\x89PNG\r\n\x1a\n";
  appendChunk(png, "IHDR", header);
  appendChunk(png, "IDAT", zlibStored(rows));
  appendChunk(png, "IEND", "");
  return png;
}

}  // namespace cnoid
