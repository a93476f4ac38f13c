// A camera's colour picture as a message of a recording, and back.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/io.h>
#include <rehearse/messages.h>

#include <cstddef>
#include <span>
#include <vector>

namespace rehearse {

/// The picture's own file, if it has one; else a PNG. A log's JPEG as a PNG would be four times as large, and its
/// encoding would take most of the time of a replay. The format of a JPEG ends with the hash of the decoded pixels.
msg::CompressedImage message_of(const msg::Header& header, const Image& image);

/// The picture and the message's header as bytes, and the encoded message_of() made of them: encoding a PNG takes long,
/// and a recording does it in a thread or process of its own.
std::vector<std::byte> raw_picture(const msg::Header& header, const Image& image);
std::vector<std::byte> compose_picture(std::span<const std::byte> raw);

/// Decodes the picture of a message; the picture keeps its file. Fails if it can't be decoded, or if libjpeg decodes
/// other pixels on this machine than in the recorded run.
Result<Image> image_of(msg::CompressedImage message);

}  // namespace rehearse
