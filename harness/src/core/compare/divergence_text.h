// Divergences: their values, their order, and their words. Internal.
#pragma once

#include <rehearse/compare.h>

#include <cstdint>
#include <string>

namespace rehearse {

/// A divergence in words: the text of its place ("tick 3 (0.003 s)"), then channel, element, expected and actual.
/// `with_stage`: false for files without ticks, where the stage has no meaning.
std::string describe(const Divergence& divergence, const std::string& place, bool with_stage);

/// Order of causes: by tick, then by stage. Equal places keep the order in which they were found.
bool comes_before(const Divergence& a, const Divergence& b);

/// Sets the values of two different cells, and their difference. Integers beyond 2^53, where doubles have gaps, are
/// also stated in the note.
void put_cells(Divergence& divergence, CellKind kind, std::uint64_t expected, std::uint64_t actual);
std::uint64_t distance_of_integers(CellKind kind, std::uint64_t a, std::uint64_t b);
/// The difference that put_numbers() writes: 0 for two NaN.
double difference_between(double expected, double actual);

}  // namespace rehearse
