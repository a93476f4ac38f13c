// The comparison of two recordings, together with the second recording.
#pragma once

#include <rehearse/compare.h>
#include <rehearse/trace.h>

#include <filesystem>
#include <vector>

namespace rehearse {

struct ComparedFiles {
  Comparison comparison;
  Trace actual;  // without messages, as Trace::load_in_pieces() returns it; an outline if nothing was compared
};

/// Like compare() of two files, which reads each of them whole. `on_actual` gets the pieces of the second file, with
/// the messages that are compared; null: nothing is called. `damage`: whether damaged files are refused, or compared by
/// their undamaged messages.
Result<ComparedFiles> compare_files(const std::filesystem::path& golden, const std::filesystem::path& actual,
                                    const std::vector<ToleranceRule>& rules, const CompareOptions& options = {},
                                    const Trace::OnPiece& on_actual = {},
                                    std::size_t window_size = Trace::usual_piece_size,
                                    Trace::Damage damage = Trace::Damage::refuse);

}  // namespace rehearse
